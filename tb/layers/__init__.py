"""cocotb benches: layers."""
