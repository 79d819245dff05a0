"""Finds gain and offset of each sensor from known placements, and writes a corrected scene."""
