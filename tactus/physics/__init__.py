"""The beam of the flexible digit in floating point, and the best places of gauges on it."""
