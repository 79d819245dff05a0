"""Checks that the arguments of floating-point models are inside their ranges."""

import numpy as np
from numpy.typing import ArrayLike

from golden.input_error import InputError
from golden.numbers.real import Real


def checked(**arguments: tuple[ArrayLike, float, float]) -> list[Real]:
    """Each argument as a float array, after a check against its least and largest value."""
    arrays = []
    for name, (value, low, high) in arguments.items():
        array = np.asarray(value, dtype=np.float64)
        outside = ~((array >= low) & (array <= high))
        if outside.any():
            raise InputError(
                f"{name}: got {array[outside].flat[0]:g}, expected {low:g} to {high:g}"
            )
        arrays.append(array)
    return arrays
