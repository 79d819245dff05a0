"""Bit-true twins of hdl/instruments."""
