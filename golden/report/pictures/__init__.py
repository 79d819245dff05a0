"""The pictures of the report: each is a function that returns the text of one ``<svg>``."""
