"""Bit-true twins of hdl/activation."""
