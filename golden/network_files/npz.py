"""Networks as NPZ files without pickle, the project's own form."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np

from golden.networks.mlp import Mlp, Real


def read(path: Path) -> dict[str, Real]:
    """Every array of an NPZ file, as float64.

    Raises
    ------
    ValueError
        When the file is no NPZ or holds no numbers.
    """
    try:
        with np.load(path, allow_pickle=False) as archive:
            return {name: np.asarray(archive[name], dtype=np.float64) for name in archive.files}
    except (zipfile.BadZipFile, EOFError, ValueError, AttributeError, TypeError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ValueError(f"{path}: not an NPZ of numbers: {reason}") from None


def write(path: Path, mlp: Mlp) -> None:
    """Write the four arrays."""
    np.savez(path, w1=mlp.w1, b1=mlp.b1, w2=mlp.w2, b2=mlp.b2)
