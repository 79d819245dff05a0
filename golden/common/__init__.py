"""What all twins share: block, port, border of registers, and flow of data."""
