"""Runs the benches of blocks in simulators, and keeps their results."""
