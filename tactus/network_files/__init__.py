"""Reads and writes trained networks."""
