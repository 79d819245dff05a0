"""Bit-true twins of hdl/networks."""
