"""The load that the networks found, drawn along the beam (thesis sections 3.13 and 5.8)."""
