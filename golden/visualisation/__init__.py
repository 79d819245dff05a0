"""Draws the load that the networks found along the beam (thesis sections 3.13 and 5.8)."""
