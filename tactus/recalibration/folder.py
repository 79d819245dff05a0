"""A copy of a scene with corrected sensors: scene file, networks, provenance and recording.

Each reading of the copy is the one that the correction turns into the recorded reading. So its
errors are those that remain if only gain and offset have changed.
"""

import json
import re
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from golden.input_error import InputError
from golden.numbers.real import Real
from golden.trained.dense import DenseNetwork
from tactus.core.files import (
    check_folder,
    check_output,
    check_writable,
    first_line,
    replace_file,
    same_file,
)
from tactus.core.folders import BUILD
from tactus.core.table import read_csv_file, read_table, write_csv_file
from tactus.network_files.network_file import (
    check_targets,
    provenance_path,
    read_provenance,
    save_networks,
)
from tactus.network_files.parsed import file_of
from tactus.scene import Scene
from tactus.scene.known_scales import codes_of, story
from tactus.scene.network import listed
from tactus.scene.scale import Scale, on_readings, on_signals, readings, signals

# Number of digits of a reading. They are two more than a code of fourteen bits can need.
DIGITS = 9


def corrected(scene: Scene, correction: Sequence[Scale]) -> list[DenseNetwork]:
    """The networks on signals, with the correction of each sensor folded into their weights."""
    found = []
    for mlp in scene.mlps():
        inputs, _, outputs = mlp.shape
        earlier = [Scale()] * (inputs - len(correction))
        found.append(on_signals(mlp, [*correction, *earlier], [Scale()] * outputs))
    return found


def now_read(scene: Scene, correction: Sequence[Scale], recorded: Real) -> Real:
    """The readings that the correction turns into recorded ones, in the units of the sensors."""
    scales = scene.scales(scene.sensors)
    return readings(signals(signals(recorded, scales), correction), scales)


def scene_file(scene: Scene, target: str) -> Path:
    """The path of the copy's scene file: a ``.toml`` file, or the scene's name in a folder.

    target: File or folder; empty for ``build/<scene>/recalibrated``.
    """
    folder = Path(target) if target else BUILD / scene.name / "recalibrated"
    path = folder if folder.suffix == ".toml" else folder / f"{scene.name}.toml"
    if same_file(path, scene.path) or same_file(path.parent, scene.path.parent):
        raise InputError(
            f"TO={path}: got the folder of the scene itself, expected another: its networks would "
            "be replaced"
        )
    return path


def check_copy(scene: Scene, path: Path, force: bool = False) -> None:
    """Refuse to replace files that are not of an earlier copy of the same scene.

    path: See ``scene_file``.
    force: Whether any files may be replaced.
    """
    if not path.is_relative_to(BUILD):
        check_folder(path.parent)
    if first_line(path) == _title(scene):
        return
    networks = dict.fromkeys(map(file_of, _weights(scene, path)))
    for file in [
        path,
        *networks,
        *map(provenance_path, networks),
        path.parent / scene.data_path.name,
    ]:
        if file.exists():
            check_output(file, scene.own_files, force=force)


def _weights(scene: Scene, path: Path) -> list[Path]:
    return [path.parent / _own(network) for network in scene.weights_paths]


def _own(network: Path) -> Path:
    """The path of a network from the folder of the copy on; its file is always an NPZ file."""
    file = file_of(network)
    return Path(f"{file.stem}.npz") / network.relative_to(file)


def _title(scene: Scene) -> str:
    return f"# {scene.name}, recalibrated: its sensors corrected in the weights. The recording is"


def write_copy(
    scene: Scene, correction: Sequence[Scale], provenance: dict[str, Any], path: Path
) -> list[Path]:
    """Write the copy, and return the files that were written.

    correction: One for each sensor; see ``fit``.
    provenance: Entries that are added to the provenance of each network.
    path: See ``scene_file``.
    """
    weights = _weights(scene, path)
    data = path.parent / scene.data_path.name
    text = _scene_text(scene, data.name)
    check_targets(weights)
    check_writable([data, path])
    networks = []
    for number, mlp in enumerate(corrected(scene, correction)):
        held = on_readings(mlp, *scene.scales_of(number))
        names = [scene.column(name) for name in scene.columns_of(number)]
        scales = {n: s for n, s in scene.known_scales.items() if n in names}
        before = read_provenance(scene.weights_paths[number]) or {}
        networks.append((weights[number], held, before | provenance | story(scales, held)))
    save_networks(networks)
    _write_recording(scene, correction, data)
    with replace_file(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
    return [path, *dict.fromkeys(map(file_of, weights)), data]


def _write_recording(scene: Scene, correction: Sequence[Scale], path: Path) -> None:
    """Write the recording with other readings, and with every other cell unchanged."""
    recorded = read_table(scene.data_path, scene.sensors)
    now = now_read(scene, correction, recorded)
    if scene.converter_scales and np.array_equal(recorded, recorded.round()):
        now = codes_of(scene, now)
    found = read_csv_file(scene.data_path)
    at, rows = [found.names.index(name) for name in scene.sensors], list(map(list, found.rows))
    for row, values in zip(rows, now.tolist(), strict=True):
        for column, value in zip(at, values, strict=True):
            row[column] = f"{value:.{DIGITS}g}"
    write_csv_file(path, [found.names, *rows])


def _scene_text(scene: Scene, data: str) -> str:
    """The scene file with other names for its files."""
    text = scene.path.read_text(encoding="utf-8")
    raw = tomllib.loads(text)
    given = raw["network"]["weights"]
    names = {name: str(_own(Path(name))) for name in listed(given)}
    weights = [names[name] for name in listed(given)] if isinstance(given, list) else names[given]
    # One recording may also be a list of one.
    key = "file" if "file" in raw["data"] else "recordings"
    (recording,) = listed(raw["data"][key])
    names[recording] = data
    wanted = raw | {
        "data": raw["data"] | {key: data if key == "file" else [data]},
        "network": raw["network"] | {"weights": weights},
    }
    # A name within another text, such as a command in data.source, stays.
    text = re.sub(
        rf"(?m)(^\s*|[=\[,]\s*)(['\"])({'|'.join(map(re.escape, names))})\2",
        lambda match: match[1] + json.dumps(names[match[3]], ensure_ascii=False),
        text,
    )
    try:
        same = tomllib.loads(text) == wanted
    except tomllib.TOMLDecodeError:
        same = False
    if not same:
        raise InputError(
            f"{scene.path}: got data.file or network.weights in a form that cannot be replaced, "
            "expected each name between quotes, and nowhere else"
        )
    return f"{_title(scene)}\n# that of the scene as the sensors would give it now.\n{text}"
