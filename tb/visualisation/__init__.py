"""cocotb benches: visualisation."""
