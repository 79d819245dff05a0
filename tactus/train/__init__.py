"""Trains the networks that scenes name."""
