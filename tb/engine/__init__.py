"""cocotb benches: engine."""
