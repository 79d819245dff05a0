"""Stiff and extreme cases: what must happen and what did happen, with a file for each field."""
