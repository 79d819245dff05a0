"""The specification that runs: formats, bit-true twins, float references, scenes and data."""
