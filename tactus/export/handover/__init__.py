"""The files beside the entities of an export, from which a user of the hardware starts."""
