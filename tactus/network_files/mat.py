"""Networks as MATLAB files with the fields of Netlab, as Appendix 5 of the thesis loads them."""

from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import loadmat, savemat

from golden.input_error import InputError
from golden.numbers.real import Real
from golden.trained.dense import DenseNetwork
from tactus.core.files import reading
from tactus.network_files.parsed import ParsedLayer, ParsedNetwork, real_numbers

# Netlab stores samples in rows, so w1 is inputs x hidden, and b1 is 1 x hidden.
TRANSPOSED = True
VARIABLE = "network"
FIELDS = ("w1", "b1", "w2", "b2")


def read(path: Path) -> ParsedNetwork:
    """The arrays of the only structure in the file that has the fields w1, b1, w2 and b2.

    The structure may have any name; the fields may also be variables of the file itself.
    """
    with reading(path, "a MATLAB file up to version 7"):
        variables = loadmat(path, squeeze_me=False, struct_as_record=False)
    names = [name for name in variables if not name.startswith("__")]
    found = [fields for name in names if (fields := _fields(variables[name]))]
    if all(name in variables for name in FIELDS):
        found.append({name: variables[name] for name in FIELDS})
    if len(found) != 1:
        raise InputError(
            f"{path}: got {len(found)} networks among the variables {', '.join(names)}, expected "
            f"one with the fields {', '.join(FIELDS)}"
        )
    w1, b1, w2, b2 = (real_numbers(path, name, found[0][name]) for name in FIELDS)
    return ParsedNetwork((ParsedLayer(w1.T, b1.ravel(), "tanh"), ParsedLayer(w2.T, b2.ravel())))


def _fields(value: Any) -> dict[str, Any] | None:
    """The four fields of a 1 x 1 structure; None for anything else."""
    if not isinstance(value, np.ndarray) or value.size != 1 or value.dtype != object:
        return None
    structure = value.ravel()[0]
    if not all(hasattr(structure, name) for name in FIELDS):
        return None
    return {name: getattr(structure, name) for name in FIELDS}


def write(path: Path, network: DenseNetwork) -> None:
    if not network.plain:
        layers = ", ".join(network.activations) or "none"
        raise InputError(
            f"got a network with hidden layers of {layers}, expected one hidden layer of "
            "tanh, which is all that a Netlab structure can hold; .npz and .onnx hold any"
        )
    fields: dict[str, Real] = {}
    for n, layer in enumerate(network.layers, start=1):
        fields |= {f"w{n}": layer.weights.T, f"b{n}": layer.biases[np.newaxis]}
    savemat(path, {VARIABLE: fields})
