"""Stiff and extreme cases: what must happen, and what did; a file for each field."""
