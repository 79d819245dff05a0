"""Gain and offset of each sensor from a few known placements, written into a copy of a scene."""
