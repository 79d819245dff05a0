"""cocotb benches: activation."""
