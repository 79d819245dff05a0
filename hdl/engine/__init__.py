"""Blocks of the engine: a program, its memories and one multiply-accumulate unit."""
