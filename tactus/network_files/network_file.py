"""Reads and writes trained networks.

The project's own format is an NPZ file of w1, b1, w2, b2 and so on, with its provenance beside it
as TOML. An NPZ file can hold several networks by name: ``rig.npz/force`` is that of the arrays
force/w1, force/b1 and so on, with a table of the provenance. Networks trained elsewhere come as
.mat in the style of Netlab or as .onnx.
"""

import json
import shutil
import tomllib
from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from golden.input_error import InputError, naming, suggest
from golden.numbers.real import Real
from golden.trained.dense import LEAK, Dense, DenseNetwork, network_of
from golden.trained.function import Function, by_name, functions_of
from tactus.core.files import (
    check_file,
    check_writable,
    reading,
    replace_file,
    replace_files,
    same_file,
)
from tactus.core.hold import held as held_folders
from tactus.network_files.npz import arrays_of
from tactus.network_files.parsed import ParsedNetwork, file_of, for_labels, name_in_file

# The module of a format is imported only when a file needs it. Those for .mat and .onnx take half a
# second to import, and every bench reads a scene when it starts.
FORMS = {f".{form}": f"tactus.network_files.{form}" for form in ("npz", "mat", "onnx")}


def provenance_path(path: Path) -> Path:
    return file_of(path).with_suffix(".provenance.toml")


def read_provenance(path: Path) -> dict[str, Any] | None:
    """The provenance beside the network at ``path``; None if there is none."""
    name, path = name_in_file(path), provenance_path(path)
    try:
        check_file(path)
    except FileNotFoundError:
        return None
    with reading(path, "TOML"):
        story = tomllib.loads(path.read_text(encoding="utf-8"))
    own = story.get(name) if name else story
    return own if isinstance(own, dict) else None


def load_network(
    path: Path,
    shape: tuple[int, ...],
    functions: Mapping[str, Function] | None = None,
    labels: Sequence[str] = (),
) -> DenseNetwork:
    """Load the network at ``path``.

    shape: Inputs, hidden nodes of each hidden layer and outputs that the network must have. With 0
        as the only number of hidden nodes, any number of layers and nodes is accepted.
    functions: The functions that an activation of the file may name, besides those that it defines.
    labels: The labels that the outputs stand for, in their order; see ``for_labels``.
    """
    form = form_of(path)
    held = held_in(path, "no such network; make train SCENE=... writes it")
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


def held_in(path: Path, missing: str = "no such file") -> ParsedNetwork:
    form = form_of(path)
    check_file(file_of(path), missing)
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
    ending, known = file_of(path).suffix, list(FORMS)
    if ending not in known:
        raise InputError(
            f"{path}: got the ending {ending!r}, expected one of {', '.join(known)}"
            f"{suggest(ending, known)}"
        )
    return import_module(FORMS[ending])


def write_network(path: Path, network: DenseNetwork) -> None:
    """Write the network in the format of the file's ending, completely or not at all."""
    form = form_of(path)
    with replace_file(path) as temporary, naming(path):
        form.write(temporary, network)


def _files_of(paths: Sequence[Path]) -> list[Path]:
    """The file of each network and, behind it, that of its provenance; each once."""
    files = dict.fromkeys(map(file_of, paths))
    return [one for file in files for one in (file, provenance_path(file))]


def check_targets(paths: Sequence[Path]) -> None:
    """Refuse paths where networks and their provenance cannot be written."""
    for path in paths:
        form_of(path)
    files = _files_of(paths)
    for i, file in enumerate(files):
        if any(same_file(file, other) for other in files[:i]):
            raise InputError(f"{file}: got two networks that write it, expected a file for each")
    check_writable(files)
    for path in paths:
        if name_in_file(path) and file_of(path).exists():
            # Both files must be readable, because what they hold of other networks stays.
            arrays_of(file_of(path))
            read_provenance(path)


# Values are texts, numbers, and tables of these.
Provenance = Mapping[str, Any]


def save_networks(networks: Sequence[tuple[Path, DenseNetwork, Provenance]]) -> None:
    """Write networks and the provenance of each, either all of them or none.

    Networks of other names stay in the files.
    """
    files = _files_of([path for path, *_ in networks])
    # Trainings of two scenes may add networks to one file.
    folders = [file.parent for file in files if file.exists()]
    with held_folders(folders), replace_files(files) as temporaries:
        temporary = dict(zip(files, temporaries, strict=True))
        for file in _files_of([path for path, *_ in networks if name_in_file(path)]):
            if file.exists():
                shutil.copyfile(file, temporary[file])
        for path, held, provenance in networks:
            name, story = name_in_file(path), temporary[provenance_path(path)]
            with naming(path):
                form_of(path).write(temporary[file_of(path)] / name, held)
            text = _lines(provenance)
            if name:
                tables = tomllib.loads(story.read_text(encoding="utf-8")) | {name: provenance}
                owners = {key.rpartition("/")[0] for key in arrays_of(temporary[file_of(path)])}
                named = {key: value for key, value in tables.items() if key in owners}
                text = "\n".join(f"[{_toml(key)}]\n{_lines(named[key])}" for key in named)
            story.write_text(text, encoding="utf-8")


def save_network(path: Path, network: DenseNetwork, provenance: Provenance) -> None:
    """Write a network and its provenance; see ``save_networks``."""
    save_networks([(path, network, provenance)])


def _lines(provenance: Provenance) -> str:
    return "".join(f"{key} = {_toml(value)}\n" for key, value in provenance.items())


def _toml(value: Any) -> str:
    """The value on one line of TOML: a text, a number or a table of these."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_toml(k)} = {_toml(v)}" for k, v in value.items()) + " }"
    # A JSON text is a TOML text too, except for the one control character that JSON does not
    # escape.
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
