"""Other projects' hardware for the same weights, beside ours: ``make peers``."""
