"""Bitstreams: a scene on a board."""
