"""What is right: numbers, networks, bit-true twins of the blocks, and the compiler of programs."""
