"""Networks as NPZ files without pickle, which is the project's own format."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from golden.dense import Trained, layers_of
from golden.files import reading
from golden.input_error import InputError
from golden.mlp import Mlp
from golden.network_files.held import Held
from golden.network_files.numbers import real_numbers

# In this format, the rows of a weight matrix are nodes.
TRANSPOSED = False
# The activation of each hidden layer, and the slope of each, which only a leaky ReLU uses. A
# network with one hidden layer of tanh has neither.
ACTIVATIONS, LEAKS = "activations", "leaks"


def read(path: Path) -> Held:
    """Read every array of an NPZ file as float64, and the activations.

    Raises
    ------
    InputError
        When the file is no NPZ or holds no numbers, or activations that are no texts.
    """
    if not zipfile.is_zipfile(path):
        raise InputError(f"{path}: not an NPZ of numbers: no zip archive")
    with reading(path, "an NPZ of numbers"), np.load(path, allow_pickle=False) as archive:
        arrays = {name: archive[name] for name in archive.files}
    named = arrays.pop(ACTIVATIONS, None)
    numbers = {name: real_numbers(path, name, array) for name, array in arrays.items()}
    if named is None:
        return Held(numbers)
    if named.ndim != 1 or named.dtype.kind != "U" or not named.size:
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
    return Held(numbers, tuple(named.tolist()), tuple(leaks.tolist()))


def write(path: Path, network: Trained) -> None:
    """Write the arrays of each layer, and the activations if they are not one layer of tanh."""
    arrays: dict[str, Any] = {}
    layers = layers_of(network)
    for n, layer in enumerate(layers, start=1):
        arrays |= {f"w{n}": layer.weights, f"b{n}": layer.biases}
    if not isinstance(network, Mlp):
        arrays[ACTIVATIONS] = np.array([layer.activation for layer in layers[:-1]])
        arrays[LEAKS] = np.array([layer.leak for layer in layers[:-1]])
    np.savez(path, **arrays)
