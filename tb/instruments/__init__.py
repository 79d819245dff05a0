"""cocotb benches: instruments."""
