"""Rules by which an engine could learn from known placements, in the formats of an engine."""
