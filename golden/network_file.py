"""Trained networks on disk: an NPZ of w1, b1, w2, b2 with its provenance beside it as TOML."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np

from golden.files import replace_file
from golden.networks.mlp import Mlp, Real

NAMES = ("w1", "b1", "w2", "b2")


def provenance_path(path: Path) -> Path:
    """Where the provenance of the network at ``path`` stands."""
    return path.with_suffix(".provenance.toml")


def load_network(path: Path, shape: tuple[int, int, int]) -> Mlp:
    """The network at ``path``.

    Parameters
    ----------
    path : Path
    shape : tuple of int
        Inputs, hidden nodes and outputs that the network must have.

    Raises
    ------
    FileNotFoundError
        When there is no such file; the message says how to train one.
    ValueError
        When the file is no NPZ, an array is missing, has another shape than expected, or holds
        NaN; the message names file and array.
    """
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such network; make train SCENE=... writes it")
    inputs, hidden, outputs = shape
    expected = {
        "w1": (hidden, inputs),
        "b1": (hidden,),
        "w2": (outputs, hidden),
        "b2": (outputs,),
    }
    found = _arrays(path)
    arrays = {}
    for name in NAMES:
        if name not in found:
            raise ValueError(f"{path}: no array {name!r}, got {', '.join(found)}")
        arrays[name] = found[name]
    for name, array in arrays.items():
        if array.shape != expected[name]:
            raise ValueError(
                f"{path}: {name}: got shape {array.shape}, expected {expected[name]} "
                f"of a {inputs}:{hidden}:{outputs} network"
            )
        if not np.isfinite(array).all():
            raise ValueError(f"{path}: {name}: got NaN or infinity, expected finite numbers")
    return Mlp(**arrays)


def _arrays(path: Path) -> dict[str, Real]:
    """Every array of an NPZ file, as float64."""
    try:
        with np.load(path, allow_pickle=False) as archive:
            return {name: np.asarray(archive[name], dtype=np.float64) for name in archive.files}
    except (zipfile.BadZipFile, EOFError, ValueError, AttributeError, TypeError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ValueError(f"{path}: not an NPZ of numbers: {reason}") from None


def save_network(path: Path, mlp: Mlp, provenance: dict[str, str | int | float]) -> None:
    """Write the network and its provenance; either file is whole or untouched."""
    with replace_file(path) as temporary:
        np.savez(temporary, w1=mlp.w1, b1=mlp.b1, w2=mlp.w2, b2=mlp.b2)
    lines = [
        f'{key} = "{value}"' if isinstance(value, str) else f"{key} = {value}"
        for key, value in provenance.items()
    ]
    with replace_file(provenance_path(path)) as temporary:
        temporary.write_text("\n".join(lines) + "\n", encoding="utf-8")
