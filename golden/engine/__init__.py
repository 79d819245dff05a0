"""The engine: one multiply-accumulate unit and a program, instead of a unit for every neuron."""
