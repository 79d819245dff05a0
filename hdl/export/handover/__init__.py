"""What an export holds beside the entities: files that a user of the hardware starts from."""
