"""The cocotb benches and properties of the blocks, one area a package."""
