"""Exports the twin of a scene as files of VHDL or Verilog."""
