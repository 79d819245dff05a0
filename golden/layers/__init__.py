"""Bit-true twins of hdl/layers."""
