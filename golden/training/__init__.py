"""Training of the networks that scenes name."""
