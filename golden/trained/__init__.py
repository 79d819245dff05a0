"""Networks in floating point: dense layers, functions of one variable, and past samples."""
