"""cocotb benches: link."""
