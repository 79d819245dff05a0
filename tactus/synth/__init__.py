"""Finds what a scene costs and how fast it is, with Yosys and nextpnr on the exported Verilog."""
