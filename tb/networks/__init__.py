"""cocotb benches: networks."""
