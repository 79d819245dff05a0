"""What a scene costs and how fast it is: Yosys and nextpnr on the exported Verilog."""
