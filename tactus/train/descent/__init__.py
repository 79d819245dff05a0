"""Trains multi-layer perceptrons by descent, from many starts, and chooses among them."""
