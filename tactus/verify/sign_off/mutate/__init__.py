"""``make mutate``: counts how many of the faults that can be put into a block its bench detects."""
