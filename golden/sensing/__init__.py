"""Bit-true twins of hdl/sensing."""
