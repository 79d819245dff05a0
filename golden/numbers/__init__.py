"""Fixed-point formats, and real functions that are the same on every processor."""
