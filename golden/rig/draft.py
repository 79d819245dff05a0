"""The text of a scene for a recording, with the reasons for what it chooses."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path

import numpy as np

from golden.disturbance import MOST
from golden.real import Real
from golden.rig import readings
from golden.rig.survey import Survey
from golden.scene import Scene
from golden.scene.scale import AUTO
from golden.scene.schema import EDITOR_SCHEMA
from golden.scene_errors import NOISE

TEMPLATE = """\
#:schema {schema}
# Written by make scene from {file}: {rows} rows. Change what you like; every key is explained in
# docs/scenes.md of tactus.

[data]
file = {quoted_file}
{left_out}sensors = {sensors}
outputs = {outputs}
{group_by}{full_scale}{scale}{units}
[network]
{arrangement}
# As many hidden nodes as training finds best.
hidden = 0
weights = {weights}

[hardware]
# One multiplier and a program for all networks, the smallest hardware there is.
design = "engine"
# Exact sums, one rounding a layer.
precision = "exact"

[training]
# Every number of hidden nodes from 4 to 12 from 8 random starts: about a minute for some hundred
# rows on two cores. More of either err a little less and take longer.
hidden = [4, 12]
restarts = 8
# Little, since readings have little noise; 1e-4 where they have much.
weight_decay = 1e-6
# With the standard deviation of the noise that is to be expected on every reading, in its unit,
# networks are trained and chosen for it, which takes longer:
# noise = {noise}
{split}"""

SINGLE = """\
# One output, one network.
arrangement = "single"\
"""
CASCADE = """\
# A network for each output, in the order of outputs; each sees the sensors and the outputs before
# its own, since what a reading says of one output often hangs on another. Put first what can be
# told from the sensors alone. With "multiple" each sees the sensors alone, and none hands its error
# on: which errs less, training tells.
arrangement = "cascade"\
"""
GROUP_BY = """\
# Rows with equal values of it are one position: errors are shown as means over positions too.
group_by = {name}
"""
FULL_SCALE = """\
# Errors are in percent of this, from the least to the largest target. Take an output out, and its
# errors are in percent of each target: only where no target is 0 or nearly.
full_scale = {{ {pairs} }}
"""
SCALE = """\
# Readings or targets leave -1 to 1, which the hardware's numbers hold: factor and offset of each
# column follow from the rows that train; those of sensors from the data sheet of a converter, where
# a section [front_end] names one.
scale = "auto"
"""
READ_BY = """\
# Sensors stand for the codes that the hardware of {name} reads, so that its engine can be loaded
# with these networks{beyond}.
{line}"""
UNITS = """\
# As the names of the columns tell; only for what is printed.
units = {{ {pairs} }}
"""
# A name with its unit behind it: load [g], load (g).
UNIT = re.compile(r".*\S\s*(?:\[([^\[\]]+)\]|\(([^()]+)\))")
BLOCKS = """\
# Many rows are means of the rows beside them: one that is held out at random has been seen. So
# stretches of neighbouring rows are held out.
split = "blocks"
"""


def draft(found: Survey, path: Path, hardware: Scene | None = None) -> str:
    """The scene that is to stand at ``path``, for sensors that ``hardware`` reads."""
    file = os.path.relpath(found.recording.path, path.parent)
    outputs = list(found.outputs)
    pairs = ", ".join(f"{_key(n)} = {_span(v)}" for n, v in found.outputs.items())
    group = _positions(found)
    told = {name: UNIT.fullmatch(name) for name in [*found.sensors, *outputs]}
    units = ", ".join(f"{_key(n)} = {_quoted(u[1] or u[2])}" for n, u in told.items() if u)
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
        outputs=_list(outputs),
        group_by=GROUP_BY.format(name=_quoted(group)) if group else "",
        full_scale=FULL_SCALE.format(pairs=pairs),
        scale=_read_by(found, hardware) if hardware else SCALE if found.beyond else "",
        units=UNITS.format(pairs=units) if units else "",
        arrangement=CASCADE if len(outputs) > 1 else SINGLE,
        weights=_list(weights(outputs, path)),
        noise=_noise(found, hardware),
        split=BLOCKS if found.interpolated else "",
    )


def _read_by(found: Survey, hardware: Scene) -> str:
    """The scale of the hardware for each sensor, and one for each output that needs it."""
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
    """A noise to begin with, in the unit of the sensors: ``NOISE`` of half their range, and no less
    than the step of their readings, of which a converter's last bit alone is a good part."""
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
    """Names of the network files, which hold the scene's: two scenes in a folder keep theirs."""
    if len(outputs) == 1:
        return [f"{path.stem}.npz"]
    plain = [re.sub(r"[^A-Za-z0-9]+", "-", name).strip("-").lower() for name in outputs]
    if "" in plain or len(set(plain)) < len(plain):
        plain = [str(number) for number in range(1, len(outputs) + 1)]
    return [f"{path.stem}-{name}.npz" for name in plain]


def _positions(found: Survey) -> str:
    """The output of the most values that come again and again; none may do."""
    counts = {name: len(np.unique(values)) for name, values in found.outputs.items()}
    often = {name: n for name, n in counts.items() if 1 < n <= len(found.recording.rows) / 2}
    return max(often, key=lambda name: often[name]) if often else ""


def _span(values: Real) -> str:
    return f"{np.ptp(values):.6g}"


def _list(names: list[str]) -> str:
    return "[" + ", ".join(map(_quoted, names)) + "]"


def _quoted(text: str) -> str:
    """A TOML string; JSON escapes as TOML does, but for one sign."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _quoted(name)
