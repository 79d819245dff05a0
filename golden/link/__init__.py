"""The serial line between an instrument and a computer."""
