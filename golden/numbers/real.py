"""The type of real numbers in all floating-point models."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.input_error import InputError

Real = NDArray[np.float64]


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
