"""Networks as NPZ files without pickle, the project's own form."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np

from golden.files import reading
from golden.input_error import InputError
from golden.mlp import Mlp
from golden.network_files.numbers import real_numbers
from golden.real import Real

# Of the weights, nodes stand in rows.
TRANSPOSED = ()


def read(path: Path) -> dict[str, Real]:
    """Every array of an NPZ file, as float64.

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
    """Write the four arrays."""
    np.savez(path, w1=mlp.w1, b1=mlp.b1, w2=mlp.w2, b2=mlp.b2)
