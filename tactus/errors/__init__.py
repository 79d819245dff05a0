"""The errors of a scene's networks on held-out rows, and their decisions."""
