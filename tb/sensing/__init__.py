"""cocotb benches: sensing."""
