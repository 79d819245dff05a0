"""Networks as NPZ files without pickle, which is the project's own format.

An array of a network among several in its file has the network's name before its own.
"""

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from golden.input_error import InputError, MissingFileError, naming
from golden.trained.dense import LEAK, DenseNetwork, Quantiser
from golden.trained.function import Function
from tactus.core.files import reading
from tactus.network_files.parsed import (
    ParsedLayer,
    ParsedNetwork,
    file_of,
    name_in_file,
    real_numbers,
)

# In this format, the rows of a weight matrix are nodes.
TRANSPOSED = False
# The activation of each hidden layer, and the slope of each, which only a leaky ReLU uses. A
# network with one hidden layer of tanh has neither.
ACTIVATIONS, LEAKS = "activations", "leaks"
# Of a quantised network a row for each hidden layer: scale, zero, the ends of the codes, the place
# of the rounding in ``ROUNDINGS``, and whether it comes before the zero; zeros where there is none.
QUANTISERS = "quantisers"
ROUNDINGS = ("even", "away", "floor")
# Before the name of a function that is a spline: its numbers, as ``Function`` has them.
SPLINE = "spline_"


def arrays_of(path: Path) -> dict[str, NDArray[Any]]:
    if not zipfile.is_zipfile(path):
        raise InputError(f"{path}: not an NPZ of numbers: no zip archive; delete it to train anew")
    with reading(path, "an NPZ of numbers"), np.load(path, allow_pickle=False) as archive:
        return {name: archive[name] for name in archive.files}


def _before(path: Path) -> str:
    return f"{name}/" if (name := name_in_file(path)) else ""


def read(path: Path) -> ParsedNetwork:
    """Read every array of a network as float64, and the activations."""
    before, every = _before(path), arrays_of(file_of(path))
    arrays = {
        name[len(before) :]: every[name]
        for name in every
        if (name.startswith(before) if before else "/" not in name)
    }
    if not arrays:
        raise MissingFileError(
            f"{path}: no such network, got {', '.join(every)}; make train SCENE=... writes it"
        )
    named = arrays.pop(ACTIVATIONS, np.array(["tanh"]))
    numbers = {name: real_numbers(path, name, array) for name, array in arrays.items()}
    splines = {name: numbers.pop(name) for name in list(numbers) if name.startswith(SPLINE)}
    with naming(f"{path}"):
        functions = tuple(
            Function(name.removeprefix(SPLINE), spline=tuple(array.ravel().tolist()))
            for name, array in splines.items()
        )
    if named.ndim != 1 or named.dtype.kind != "U":
        raise InputError(
            f"{path}: {ACTIVATIONS}: got {named.dtype} of shape {named.shape}, expected a text for "
            "each hidden layer"
        )
    leaks = numbers.pop(LEAKS, np.zeros(0)).ravel()
    if leaks.size not in (0, named.size):
        raise InputError(
            f"{path}: {LEAKS}: got {leaks.size} numbers, expected {named.size}, one for each "
            "hidden layer"
        )
    rows = numbers.pop(QUANTISERS, np.zeros((0, 6)))
    if rows.shape not in ((0, 6), (named.size, 6)):
        raise InputError(
            f"{path}: {QUANTISERS}: got shape {rows.shape}, expected {(named.size, 6)}"
        )
    with naming(f"{path}: {QUANTISERS}"):
        quantisers = [*map(_quantiser, rows.tolist())] or [None] * named.size
    for name in [f"{kind}{n}" for n in range(1, named.size + 2) for kind in "wb"]:
        if name not in numbers:
            raise InputError(f"{path}: no array {name!r}, got {', '.join(numbers)}")
    beyond = f"w{named.size + 2}"
    if beyond in numbers:
        raise InputError(
            f"{path}: got an array {beyond!r} and {named.size} activations, expected an activation "
            "for each layer but the last"
        )
    slopes = leaks.tolist() or [LEAK] * named.size
    parts = [*named.tolist(), "linear"], [*slopes, LEAK], [*quantisers, None]
    layers = (
        ParsedLayer(numbers[f"w{n}"], numbers[f"b{n}"], *own)
        for n, own in enumerate(zip(*parts, strict=True), 1)
    )
    return ParsedNetwork(tuple(layers), functions)


def _quantiser(row: list[float]) -> Quantiser | None:
    """The quantiser that a row tells of; None for zeros."""
    if not any(row):
        return None
    scale, *others = row
    if not all(float(value).is_integer() for value in others) or not 0 <= others[3] < 3:
        raise InputError(
            f"got {row}, expected a scale, whole numbers for the zero point and both ends of the "
            "codes, a rounding from 0 to 2, and 0 or 1"
        )
    zero, low, high, rounding, before_zero = map(int, others)
    return Quantiser(scale, zero, low, high, ROUNDINGS[rounding], bool(before_zero))


def _row(quantiser: Quantiser | None) -> list[float]:
    if quantiser is None:
        return [0.0] * 6
    q = quantiser
    return [q.scale, q.zero, q.low, q.high, ROUNDINGS.index(q.rounding), q.before_zero]


def write(path: Path, network: DenseNetwork) -> None:
    """Write the arrays of each layer, and the activations if they are not one layer of tanh.

    Networks of other names in the file stay.
    """
    arrays: dict[str, Any] = {}
    layers = network.layers
    for n, layer in enumerate(layers, start=1):
        arrays |= {f"w{n}": layer.weights, f"b{n}": layer.biases}
    if not network.plain:
        arrays[ACTIVATIONS] = np.array([layer.activation for layer in layers[:-1]], dtype=np.str_)
        arrays[LEAKS] = np.array([layer.leak for layer in layers[:-1]])
        for layer in layers:
            for function in layer.functions:
                if function.spline:
                    arrays[SPLINE + function.name] = np.array(function.spline)
        if network.quantised:
            rows = [_row(layer.quantiser) for layer in layers[:-1]]
            arrays[QUANTISERS] = np.array(rows, dtype=np.float64)
    before, file = _before(path), file_of(path)
    arrays = {before + name: array for name, array in arrays.items()}
    if before and file.stat().st_size:
        every = arrays_of(file)
        arrays |= {n: every[n] for n in every if "/" in n and not n.startswith(before)}
    np.savez(file, **arrays)
