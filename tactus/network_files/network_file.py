"""Reads and writes trained networks.

The project's own format is an NPZ file of w1, b1, w2, b2 and so on, with its provenance beside it
as TOML. Networks trained elsewhere come as .mat in the style of Netlab or as .onnx. A scene can
name files of all three formats.
"""

import json
import tomllib
from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from golden.input_error import InputError, naming, suggest
from golden.numbers.real import Real
from golden.trained.dense import LEAK, Dense, Trained, network_of
from golden.trained.function import Function, by_name, functions_of
from tactus.core.files import (
    check_file,
    check_writable,
    reading,
    replace_file,
    replace_files,
    same_file,
)
from tactus.network_files.parsed import ParsedNetwork, for_labels

# The module of a format is imported only when a file needs it. Those for .mat and .onnx take half a
# second to import, and every bench reads a scene when it starts.
FORMS = {f".{form}": f"tactus.network_files.{form}" for form in ("npz", "mat", "onnx")}


def provenance_path(path: Path) -> Path:
    return path.with_suffix(".provenance.toml")


def read_provenance(path: Path) -> dict[str, Any] | None:
    """The provenance beside the network at ``path``; None if there is none."""
    path = provenance_path(path)
    try:
        check_file(path)
    except FileNotFoundError:
        return None
    with reading(path, "TOML"):
        return tomllib.loads(path.read_text(encoding="utf-8"))


def load_network(
    path: Path,
    shape: tuple[int, ...],
    functions: Mapping[str, Function] | None = None,
    labels: Sequence[str] = (),
) -> Trained:
    """Load the network at ``path``.

    shape: Inputs, hidden nodes of each hidden layer and outputs that the network must have. With 0
        as the only number of hidden nodes, any number of layers and nodes is accepted.
    functions: The functions that an activation of the file may name, besides those that it defines.
    labels: The labels that the outputs stand for, in their order; see ``for_labels``.
    """
    form = form_of(path)
    check_file(path, "no such network; make train SCENE=... writes it")
    held = form.read(path)
    if labels:
        held = for_labels(path, held, labels)
    inputs, *hidden, outputs = shape
    if hidden == [0]:
        hidden = [np.size(layer.biases) for layer in held.layers[:-1]]
    for n, nodes in enumerate(hidden, start=1):
        if not nodes:
            raise InputError(f"{path}: b{n}: got 0 hidden nodes, expected 1 or more")
    widths = [inputs, *hidden, outputs]
    text = ":".join(map(str, widths))
    if len(hidden) != len(held.activations):
        raise InputError(
            f"{path}: hidden layers: got {len(held.activations)}, expected {len(hidden)} of a "
            f"{text} network"
        )
    known = {**(functions or {}), **by_name(held.functions)}
    layers = []
    for n, one in enumerate(held.layers, start=1):
        shape = widths[n], widths[n - 1]
        _check_array(path, f"w{n}", one.weights, shape, text, form.TRANSPOSED)
        _check_array(path, f"b{n}", one.biases, shape[:1], text, form.TRANSPOSED)
        leak = one.leak if one.activation == "leaky_relu" else LEAK
        with naming(f"{path}: layer {n}"):
            tables = functions_of(one.activation, widths[n], known)
            layers.append(
                Dense(one.weights, one.biases, one.activation, leak, one.quantiser, tables)
            )
    return network_of(layers)


def held_in(path: Path) -> ParsedNetwork:
    form = form_of(path)
    check_file(path)
    return form.read(path)


def _check_array(
    path: Path, name: str, array: Real, expected: tuple[int, ...], text: str, transposed: bool
) -> None:
    """Refuse an array that has another shape or holds numbers that are not finite.

    ``transposed`` says whether the columns of the file's weights are nodes.
    """
    if array.shape != expected:
        # The message shows the shapes as they are in the file.
        way = -1 if transposed and len(expected) == 2 else 1
        hint = "; it is transposed" if array.T.shape == expected else ""
        raise InputError(
            f"{path}: {name}: got shape {array.shape[::way]}, expected {expected[::way]} of a "
            f"{text} network{hint}"
        )
    if not np.isfinite(array).all():
        raise InputError(f"{path}: {name}: got NaN or infinity, expected finite numbers")


def form_of(path: Path) -> ModuleType:
    """The module that reads and writes files with this ending."""
    if path.suffix not in FORMS:
        known = list(FORMS)
        raise InputError(
            f"{path}: got the ending {path.suffix!r}, expected one of {', '.join(known)}"
            f"{suggest(path.suffix, known)}"
        )
    return import_module(FORMS[path.suffix])


def write_network(path: Path, network: Trained) -> None:
    """Write the network in the format of the file's ending, completely or not at all."""
    form = form_of(path)
    with replace_file(path) as temporary, naming(path):
        form.write(temporary, network)


def check_targets(paths: Sequence[Path]) -> None:
    """Refuse paths where networks and their provenance cannot be written."""
    for path in paths:
        form_of(path)
    files = [file for path in paths for file in _files(path)]
    for i, file in enumerate(files):
        if any(same_file(file, other) for other in files[:i]):
            raise InputError(f"{file}: got two networks that write it, expected a file for each")
    check_writable(files)


def _files(path: Path) -> tuple[Path, Path]:
    return path, provenance_path(path)


# Values are texts, numbers, and tables of these.
Provenance = Mapping[str, Any]


def save_networks(networks: Sequence[tuple[Path, Trained, Provenance]]) -> None:
    """Write networks and the provenance of each, either all of them or none."""
    with replace_files([file for path, *_ in networks for file in _files(path)]) as temporaries:
        for number, (path, held, provenance) in enumerate(networks):
            network, story = temporaries[2 * number : 2 * number + 2]
            with naming(path):
                form_of(path).write(network, held)
            lines = [f"{key} = {_toml(value)}" for key, value in provenance.items()]
            story.write_text("\n".join(lines) + "\n", encoding="utf-8")


def save_network(path: Path, network: Trained, provenance: Provenance) -> None:
    """Write a network and its provenance; see ``save_networks``."""
    save_networks([(path, network, provenance)])


def _toml(value: Any) -> str:
    """The value on one line of TOML: a text, a number or a table of these."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_toml(k)} = {_toml(v)}" for k, v in value.items()) + " }"
    # A JSON text is a TOML text too, except for the one control character that JSON does not
    # escape.
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
