"""Turns the contents of a file into arrays of real numbers, for all formats."""

from pathlib import Path
from typing import Any

import numpy as np

from golden.input_error import InputError
from golden.numbers.real import Real


def real_numbers(path: Path, name: str, value: Any) -> Real:
    """Turn an array into float64."""
    array = np.asarray(value)
    if array.dtype.kind not in "biuf":
        raise InputError(f"{path}: {name}: got {array.dtype}, expected real numbers")
    return array.astype(np.float64)
