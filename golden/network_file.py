"""Trained networks on disk.

The project's own form is an NPZ of w1, b1, w2 and b2 with its provenance beside it as TOML;
networks trained elsewhere come as Netlab-style .mat or as .onnx. A scene can name any of the three.
"""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np

from golden.files import replace_file
from golden.network_mat import read_mat, write_mat
from golden.network_onnx import read_onnx, write_onnx
from golden.networks.mlp import Mlp, Real
from golden.table import suggest

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
        Inputs, hidden nodes and outputs that the network must have; 0 hidden nodes take as many
        as it has.

    Raises
    ------
    FileNotFoundError
        When there is no such file; the message says how to train one.
    ValueError
        When the file's ending or contents are none of the three forms, an array is missing, has
        another shape than expected, or holds NaN; the message names file and array.
    """
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such network; make train SCENE=... writes it")
    found = READERS[_form(path)](path)
    inputs, hidden, outputs = shape
    hidden = hidden or np.size(found.get("b1", 0))
    expected = {
        "w1": (hidden, inputs),
        "b1": (hidden,),
        "w2": (outputs, hidden),
        "b2": (outputs,),
    }
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


def _form(path: Path) -> str:
    """The file's ending, which tells its form."""
    if path.suffix not in READERS:
        known = list(READERS)
        raise ValueError(
            f"{path}: got the ending {path.suffix!r}, expected one of {', '.join(known)}"
            f"{suggest(path.suffix, known)}"
        )
    return path.suffix


def read_npz(path: Path) -> dict[str, Real]:
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


def write_npz(path: Path, mlp: Mlp) -> None:
    """Write the four arrays."""
    np.savez(path, w1=mlp.w1, b1=mlp.b1, w2=mlp.w2, b2=mlp.b2)


READERS = {".npz": read_npz, ".mat": read_mat, ".onnx": read_onnx}
WRITERS = {".npz": write_npz, ".mat": write_mat, ".onnx": write_onnx}


def write_network(path: Path, mlp: Mlp) -> None:
    """Write the network in the form that the file's ending asks for; whole or not at all.

    Raises
    ------
    ValueError
        For another ending than .npz, .mat or .onnx.
    """
    write = WRITERS[_form(path)]
    with replace_file(path) as temporary:
        write(temporary, mlp)


def save_network(path: Path, mlp: Mlp, provenance: dict[str, str | int | float]) -> None:
    """Write the network and its provenance; either file is whole or untouched."""
    write_network(path, mlp)
    lines = [
        f'{key} = "{value}"' if isinstance(value, str) else f"{key} = {value}"
        for key, value in provenance.items()
    ]
    with replace_file(provenance_path(path)) as temporary:
        temporary.write_text("\n".join(lines) + "\n", encoding="utf-8")
