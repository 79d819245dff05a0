"""Writes a scene for a recording, with comments that explain what was chosen."""

import csv
import json
import os
import re
from pathlib import Path

import numpy as np

from golden.input_error import InputError
from golden.numbers.real import Real
from tactus.core.files import replace_file
from tactus.errors.scene_errors import NOISE
from tactus.network_files.network_file import provenance_path
from tactus.rig import readings
from tactus.rig.network_of_others import Brought
from tactus.rig.survey import Survey, labels_in
from tactus.scene import Scene, load_scene
from tactus.scene.disturbance import MOST
from tactus.scene.reading import EDITOR_SCHEMA
from tactus.scene.scale import AUTO
from tactus.train.descent.split import scaled

TEMPLATE = """\
#:schema {schema}
# Written by make scene from {file}: {rows} rows. Change what you like; every key is explained in
# docs/scenes.md of tactus.

[data]
file = {quoted_file}
{left_out}sensors = {sensors}
{targets}
{group_by}{full_scale}{scale}{units}
[network]
{arrangement}
{hidden}
weights = {weights}

[hardware]
# One multiplier and a program for all networks, the smallest hardware there is.
design = "engine"
# Sums are exact, and each layer rounds once.
precision = "exact"
{training}"""
TRAINING = """
[training]
{search}
# State the standard deviation of the noise that you expect on every reading, in its unit, and
# networks are trained and chosen for this noise, which takes longer:
# noise = {noise}
{split}"""
BROUGHT = """\
# The network comes from elsewhere. Its layers are those of its file, and make train would overwrite
# it: choose another name in weights before.
hidden = {nodes}{activations}\
"""
RANGES = """\
# The network in {name} takes readings in their units, but does not say which range they can have.
# The hardware needs it: codes hold offset - factor to offset + factor. These ranges are {how}.
# FILL IN the ranges of your converter, if you know them, for {names}.
scale = {{ {pairs} }}
"""
OF_ROWS = "those of the\n# recorded rows, with a tenth to spare"
POWERS = "powers\n# of two around the recorded rows, with which a quantised network can be exact"

SEARCHED = """\
# Up to nine numbers of hidden nodes from 4 to 12 are tried from 8 random starts, in about a minute
# for some hundred rows on two cores. More of either lower the errors a little and take longer.
hidden = [4, 12]
restarts = 8
# A small value, because readings have little noise; use 1e-4 where they have much.
weight_decay = 1e-6\
"""
NODES = """\
# Training finds the best number of hidden nodes.
hidden = 0\
"""
CLASSES = """\
# The network has an output for each label in this column; the largest output is its decision.
classes = {name}\
"""
CLASS_NODES = """\
# The nodes of each hidden layer. Try more, or a second layer, [16, 8], if the decisions on held-out
# rows are not right often enough. Instead of these two keys, layers = [0, 2] in [training] tries
# how many layers are best.
hidden = [16]
activations = ["relu"]\
"""
CLASS_SEARCH = """\
# An optimiser whose steps are cheap in networks of many weights, which takes more of them.
optimiser = "scg"
steps = 500
# The best of so many random starts is kept.
restarts = 8
# A larger value keeps the network from learning single rows by heart; a smaller one fits closer.
weight_decay = 0.03\
"""
ONE_OUTPUT = "# One output, one network."
ONE_FROM_ELSEWHERE = "# One network for all outputs, as the file has it."
ONE_FOR_ALL = "# One network with an output for each class."
SINGLE = """\
{why}
arrangement = "single"\
"""
CASCADE = """\
# A network for each output, in the order of outputs. Each network sees the sensors and the outputs
# before its own, because what a reading says about one output often depends on another. Put first
# the outputs that follow from the sensors alone. With "multiple" each network sees sensors only,
# and none passes its error on. Train with both to find out which has smaller errors.
arrangement = "cascade"\
"""
GROUP_BY = """\
# Rows with equal values in it are one position. Errors are also shown as means over positions.
group_by = {name}
"""
FULL_SCALE = """\
# Errors are in percent of this, the distance from the least to the largest target. Without an entry
# here, errors of an output are in percent of each target, which works only if no target is 0.
full_scale = {{ {pairs} }}
"""
SCALE = """\
# Readings or targets exceed -1 to 1, the range of the hardware's numbers. So every column gets a
# factor and an offset. They follow from the rows that train or, for sensors, from the data sheet of
# a converter if a section [front_end] names one.
scale = "auto"
"""
READ_BY = """\
# Sensors have the scale with which the hardware of {name} reads them, so that its engine can be
# loaded with these networks{beyond}.
{line}"""
UNITS = """\
# The units come from the names of the columns; they are only used for what is printed.
units = {{ {pairs} }}
"""
# A name followed by its unit: load [g] or load (g).
UNIT = re.compile(r".*\S\s*(?:\[([^\[\]]+)\]|\(([^()]+)\))")
BLOCKS = """\
# Many rows are means of the rows beside them, so training would have seen a row that is held out at
# random. Therefore stretches of neighbouring rows are held out.
split = "blocks"
"""
SESSIONS = """\
# Rows of one session or person are alike. So all of some are held out, and the errors on held-out
# rows are those of sessions that training has not seen.
split = "groups"
split_by = {names}
"""
# The fewest rows of a session, in the mean.
ROWS_OF_SESSION = 8


def draft(
    found: Survey, path: Path, hardware: Scene | None = None, network: Brought | None = None
) -> str:
    """The text of the scene at ``path``.

    hardware: Scene whose hardware reads the sensors.
    network: The network that the scene is for. It is not trained.
    """
    file = os.path.relpath(found.recording.path, path.parent)
    outputs = list(found.outputs)
    pairs = ", ".join(f"{_key(n)} = {_span(v)}" for n, v in found.outputs.items())
    session = _session(found)
    group, targets = session or _positions(found), f"outputs = {_list(outputs)}"
    named = {name: UNIT.fullmatch(name) for name in [*found.sensors, *outputs]}
    units = ", ".join(f"{_key(n)} = {_quoted(u[1] or u[2])}" for n, u in named.items() if u)
    return TEMPLATE.format(
        schema=_quoted(os.path.relpath(EDITOR_SCHEMA, path.parent))[1:-1],
        file=_quoted(Path(file).name)[1:-1],
        rows=len(found.recording.rows),
        quoted_file=_quoted(file),
        left_out="".join(
            f"# Left out: {_quoted(n)[1:-1]}, {_quoted(why)[1:-1]}.\n"
            for n, why in found.left_out.items()
        ),
        sensors=_list(list(found.sensors)),
        targets=CLASSES.format(name=_quoted(found.classes)) if found.classes else targets,
        hidden=_hidden(found, network),
        group_by=GROUP_BY.format(name=_quoted(group)) if group else "",
        full_scale=FULL_SCALE.format(pairs=pairs) if outputs else "",
        scale=_scale(found, hardware, network),
        units=UNITS.format(pairs=units) if units else "",
        arrangement=_arrangement(found, network),
        weights=_list(_files(found, path, network)),
        training="" if network else _training(found, hardware),
    )


def _arrangement(found: Survey, network: Brought | None) -> str:
    if network and not found.classes:
        return SINGLE.format(why=ONE_FROM_ELSEWHERE)
    if len(found.outputs) > 1:
        return CASCADE
    return SINGLE.format(why=ONE_FOR_ALL if found.classes else ONE_OUTPUT)


def _files(found: Survey, path: Path, network: Brought | None) -> list[str]:
    if network:
        return [os.path.relpath(network.path, path.parent)]
    return weights(list(found.outputs), path)


def _hidden(found: Survey, network: Brought | None) -> str:
    if network is None:
        return CLASS_NODES if found.classes else NODES
    nodes = network.shape[1:-1]
    kinds = network.activations
    return BROUGHT.format(
        nodes=nodes[0] if len(nodes) == 1 else list(nodes),
        activations=f"\nactivations = {_list(list(kinds))}" if kinds else "",
    )


def _training(found: Survey, hardware: Scene | None) -> str:
    return TRAINING.format(
        search=CLASS_SEARCH if found.classes else SEARCHED,
        noise=_noise(found, hardware),
        split=_split(found),
    )


def _split(found: Survey) -> str:
    session = _session(found)
    if session:
        return SESSIONS.format(names=_list([session]))
    return BLOCKS if found.interpolated else ""


def _session(found: Survey) -> str:
    """The column of texts that repeat most, such as sessions or persons; empty if there is none."""
    counts = {}
    for name in found.recording.names:
        if name and name != found.classes and not found.recording.column(name).numeric:
            texts = labels_in(found.recording, name)
            if all(texts) and 1 < len(set(texts)) <= len(texts) / ROWS_OF_SESSION:
                counts[name] = len(set(texts))
    return min(counts, key=lambda name: counts[name]) if counts else ""


def _scale(found: Survey, hardware: Scene | None, network: Brought | None) -> str:
    """The line of scales with its comment; empty where every column is within -1 and 1."""
    if hardware:
        return _read_by(found, hardware)
    if network is None or not found.beyond:
        return SCALE if found.beyond else ""
    columns = found.sensors | found.outputs
    wide = {n: network.range_of(v) for n, v in columns.items() if readings.beyond(n, v)}
    pairs = [
        f"{_key(name)} = {{ offset = {offset!r}, factor = {factor!r} }}"
        for name, (offset, factor) in wide.items()
    ]
    return RANGES.format(
        name=network.path.name,
        how=POWERS if any(network.held.quantisers) else OF_ROWS,
        names=", ".join(map(_key, wide)),
        pairs=", ".join(pairs),
    )


def _read_by(found: Survey, hardware: Scene) -> str:
    """The hardware's scale for each sensor, and a scale for each output that needs one."""
    scales = hardware.known_scales
    pairs = [
        f"{_key(name)} = {{ offset = {scales[name].offset!r}, factor = {scales[name].factor!r} }}"
        for name in found.sensors
        if name in scales
    ]
    wide = [name for name, values in found.outputs.items() if readings.beyond(name, values)]
    pairs += [f'{_key(name)} = "{AUTO}"' for name in wide]
    return READ_BY.format(
        name=hardware.path.stem,
        beyond="; outputs leave -1 to 1, and get a scale" if wide else "",
        line=f"scale = {{ {', '.join(pairs)} }}\n" if pairs else "",
    )


def _noise(found: Survey, hardware: Scene | None) -> str:
    """A first value for the noise, in the unit of the sensors.

    It is ``NOISE`` times half the range of the sensors, but at least the step of their readings,
    because the last bit of a converter is already a large part of its noise.
    """
    columns = list(found.sensors.values())
    if hardware:
        halves = [scale.factor for scale in hardware.scales(list(found.sensors))]
    elif found.beyond:
        halves = [float(values.max() / 2 - values.min() / 2) for values in columns]
    else:
        halves = [1.0]
    noise = max(NOISE * float(np.median(halves)), *map(readings.step, columns))
    return f"{float(f'{min(noise, MOST):.0e}'):g}"


def weights(outputs: list[str], path: Path) -> list[str]:
    """Names of the network files, which contain the scene's, so scenes can share a folder."""
    if len(outputs) <= 1:
        return [f"{path.stem}.npz"]
    plain = [re.sub(r"[^A-Za-z0-9]+", "-", name).strip("-").lower() for name in outputs]
    if "" in plain or len(set(plain)) < len(plain):
        plain = [str(number) for number in range(1, len(outputs) + 1)]
    return [f"{path.stem}-{name}.npz" for name in plain]


def _positions(found: Survey) -> str:
    """Of the outputs that were set, so that every value repeats, the one with the most values."""
    counts = {n: np.unique(v, return_counts=True)[1] for n, v in found.outputs.items()}
    often = {name: len(rows) for name, rows in counts.items() if rows.min() > 1}
    return max(often, key=lambda name: often[name]) if often else ""


def _span(values: Real) -> str:
    return f"{np.ptp(values):.6g}"


def _list(names: list[str]) -> str:
    return "[" + ", ".join(map(_quoted, names)) + "]"


def _quoted(text: str) -> str:
    """A TOML string; JSON escapes in the same way except for one character."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _quoted(name)


def names_of(text: str) -> list[str]:
    """Column names separated by commas; a name that contains a comma is in double quotes."""
    try:
        return [name.strip() for name in next(csv.reader([text], skipinitialspace=True), [])]
    except csv.Error as error:
        raise InputError(f"OUTPUTS={text!r}: got no names between commas: {error}") from None


def check_sensors(found: Survey, hardware: Scene) -> None:
    """Refuse a recording with other sensors than those that a scene's hardware reads."""
    got = tuple(found.sensors)
    if got != hardware.sensors:
        why = "".join(
            f"; {name} is left out: {found.left_out[name]}"
            for name in hardware.sensors
            if name in found.left_out
        )
        raise InputError(
            f"{found.recording.path}: got the sensors {', '.join(got)}, expected "
            f"{', '.join(hardware.sensors)}, as {hardware.path} reads them{why}"
        )


def write_scene(
    found: Survey, path: Path, hardware: Scene | None = None, network: Brought | None = None
) -> Scene:
    """Write the scene, after a check that it can be read.

    hardware: Scene whose hardware has read the sensors, and will run the networks.
    network: The network that the scene is for.
    """
    with replace_file(path) as temporary:
        temporary.write_text(draft(found, path, hardware, network), encoding="utf-8")
        scene = load_scene(str(temporary))
        scaled(scene).vectors()
        if network:
            scene.networks()
        trained = [*scene.weights_paths, *map(provenance_path, scene.weights_paths)]
        files = [path] if network else [path, *trained]
        for file in files:
            if file.exists() or file.is_symlink():
                raise InputError(f"{file}: is there already; choose another name with TO=")
    return load_scene(str(path))
