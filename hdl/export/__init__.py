"""From a scene's twin to files of VHDL or Verilog."""
