"""Networks as NPZ files without pickle, which is the project's own format."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np

from golden.files import reading
from golden.input_error import InputError
from golden.mlp import Mlp
from golden.network_files.numbers import real_numbers
from golden.real import Real

# In this format, the rows of a weight matrix are nodes.
TRANSPOSED = ()


def read(path: Path) -> dict[str, Real]:
    """Read every array of an NPZ file as float64.

    Raises
    ------
    InputError
        When the file is no NPZ or holds no numbers.
    """
    if not zipfile.is_zipfile(path):
        raise InputError(f"{path}: not an NPZ of numbers: no zip archive")
    with reading(path, "an NPZ of numbers"), np.load(path, allow_pickle=False) as archive:
        arrays = {name: archive[name] for name in archive.files}
    return {name: real_numbers(path, name, array) for name, array in arrays.items()}


def write(path: Path, mlp: Mlp) -> None:
    """Write the four arrays of a network."""
    np.savez(path, w1=mlp.w1, b1=mlp.b1, w2=mlp.w2, b2=mlp.b2)
