"""What stands in, inside a simulator, for packages that cocotb imports there and no bench uses."""
