"""Reads the recorded vectors of a scene."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.input_error import InputError
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from tactus.core.table import (
    holds_texts,
    number_of,
    read_groups,
    read_table,
    read_texts,
    rows_where,
)
from tactus.scene.labels import one_hot, wrong_percent
from tactus.scene.scale import Scale, readings, signals

if TYPE_CHECKING:
    from tactus.scene.scene import Scene

# The largest part of a sensor's readings outside the codes' range. If there are more, they are no
# outliers, but in another unit.
MOST_OUTSIDE = 0.1

Rows = NDArray[np.intp]


@dataclass(frozen=True)
class Recording:
    """The rows of one file that a scene uses, in the units of the columns.

    sensors, shape (rows, sensors): If there is a window, the rows follow each other in time.
    targets, shape (rows, outputs): If the scene has classes, 1 for the class of the row and 0 for
        the others.
    groups, shape (rows,): Positions; zeros where the scene has none.
    numbers, shape (rows,): Numbers of these rows in the file, counted from 0.
    """

    path: Path
    sensors: Real
    targets: Real
    groups: Real
    numbers: Rows


@dataclass(frozen=True)
class Recorded:
    """Inputs and targets of a scene's networks, for every row that has a complete past.

    The rows of the recordings follow each other, one recording after the other.

    inputs, shape (rows, inputs): The networks' inputs in the units of the sensors.
    sensors, shape (rows, sensors): The newest frame of each row, in the same units.
    targets, shape (rows, outputs): In the units of the outputs.
    groups, shape (rows,): See ``Recording``.
    numbers, shape (rows,): The number of each row in its file, counted from 0.
    runs, shape (rows,): The index of the recording of each row.
    without_past: The number of rows that are not used because their past is not complete.
    """

    recordings: tuple[Recording, ...]
    inputs: Real
    sensors: Real
    targets: Real
    groups: Real
    numbers: Rows
    runs: Rows
    without_past: int


def read_recorded(scene: Scene) -> Recorded:
    past = scene.window.past
    recordings = tuple(_recording(scene, path) for path in scene.data_paths)
    for one in recordings:
        if len(one.numbers) <= past:
            raise InputError(
                f"{one.path}: got {len(one.numbers)} rows, expected more than the {past} that "
                f"data.window of {scene.path} reaches back"
            )
    parts = [
        (one.sensors, one.targets, one.groups, one.numbers, np.full(len(one.numbers), run))
        for run, one in enumerate(recordings)
    ]
    sensors, targets, groups, numbers, runs = (
        np.concatenate([part[past:] for part in kind]) for kind in zip(*parts, strict=True)
    )
    inputs = np.concatenate([scene.window.frames(one.sensors) for one in recordings])
    without = past * len(recordings)
    return Recorded(recordings, inputs, sensors, targets, groups, numbers, runs, without)


def place_names(scene: Scene) -> dict[float, str]:
    """The text of each position, if ``group_by`` is a column of texts; else none."""
    texts: set[str] = set()
    for path in scene.data_paths if scene.group_by else ():
        if holds_texts(path, scene.group_by):
            texts.update(read_texts(path, scene.group_by))
    return {number_of(text): text for text in sorted(texts)}


def _recording(scene: Scene, path: Path) -> Recording:
    kept = rows_where(path, scene.where)
    sensors = read_table(path, scene.sensors)[kept]
    if scene.labels:
        targets = one_hot(read_texts(path, scene.classes), scene.labels)[kept]
    else:
        targets = read_table(path, scene.outputs)[kept]
    groups = np.zeros(len(kept))
    if scene.group_by:
        groups = read_groups(path, [scene.group_by])[kept, 0]
    return Recording(path, sensors, targets, groups, kept)


@dataclass(frozen=True)
class Vectors:
    """Recorded vectors as the hardware uses them: inputs and targets as signals, inputs as codes.

    inputs, shape (rows, inputs): Inputs of the networks; without a past these are the frames.
    targets: shape (rows, outputs).
    scale, shape (rows, outputs): The divisor of an error, as a signal: the target or a full scale.
    groups, shape (rows,): Positions in the unit of their column; see ``place_names`` for texts.
    codes: shape (rows, inputs).
    recordings, shape (frames, sensors): The codes of the frames of each recording, as they are sent
        to the hardware. If there is a window, these are more frames than there are rows.
    saturated: Readings outside [-1, 1) that were replaced by the nearest code.
    outside: A sentence for each sensor with readings outside the range of the codes.
    classes: Whether the outputs stand for classes, with one-hot targets.
    """

    inputs: Real
    targets: Real
    scale: Real
    groups: Real
    codes: Codes
    recordings: tuple[Codes, ...]
    saturated: int
    outside: tuple[str, ...]
    classes: bool = False

    @property
    def samples(self) -> int:
        return sum(codes.size for codes in self.recordings)

    def percent_errors(self, results: Real) -> Real:
        """Errors in percent for results as signals, shape (..., rows, outputs).

        They are those of equation 3.16 or, of a class, 100 if the decision is wrong about it; see
        ``wrong_percent``.
        """
        if self.classes:
            return wrong_percent(results, self.targets)
        return 100 * np.abs(self.targets - results) / self.scale


def error_scale(targets: ArrayLike, outputs: Sequence[str], full_scale: dict[str, float]) -> Real:
    """The divisor of each error: the full scale of its output, or the target's magnitude.

    By equation 3.16 the error in percent is ``100 * |t - y|`` divided by it.

    targets: shape (frames, outputs).
    outputs: Names of the columns.
    full_scale: Scales of the outputs whose error is divided by a constant (position and width:
        0.9).
    """
    scale = np.abs(np.asarray(targets, dtype=np.float64))
    for c, name in enumerate(outputs):
        if name in full_scale:
            scale[:, c] = full_scale[name]
    return scale


def read_vectors(scene: Scene) -> Vectors:
    """Read the recorded vectors of a scene, and quantise them."""
    rows = read_recorded(scene)
    scales = scene.scales(scene.outputs)
    targets = signals(rows.targets, scales)
    beyond = np.argwhere(np.abs(targets) > 1)
    if len(beyond):
        row, c = beyond[0]
        path = rows.recordings[rows.runs[row]].path
        raise InputError(
            f"{path}: column {scene.outputs[c]!r}: got a target of "
            f"{rows.targets[row, c]:g} in row {rows.numbers[row] + 1}, expected "
            f"{_range(scales[c])}, the range of {SIGNAL}; {_remedy(scene, scene.outputs[c])}"
        )
    for c, name in enumerate(scene.outputs):
        zero = np.flatnonzero(rows.targets[:, c] == 0)
        if name not in scene.full_scale and len(zero):
            raise InputError(
                f"{rows.recordings[rows.runs[zero[0]]].path}: column {name!r} holds a target of "
                f"0, whose relative error is not defined; give {name} a full_scale in {scene.path}"
            )
    of_sensors = scene.scales(scene.sensors)
    frames = [signals(one.sensors, of_sensors) for one in rows.recordings]
    outside = tuple(_outside(scene, rows, frames))
    coded = [
        SIGNAL.quantise(part, f"{one.path} sensors")
        for part, one in zip(frames, rows.recordings, strict=True)
    ]
    counts = error_scale(rows.targets, scene.outputs, scene.full_scale)
    return Vectors(
        np.concatenate([scene.window.frames(part) for part in frames]),
        targets,
        counts / [s.factor for s in scales],
        rows.groups,
        np.concatenate([scene.window.frames(codes) for codes, _ in coded]),
        tuple(codes for codes, _ in coded),
        sum(saturated for _, saturated in coded),
        outside,
        bool(scene.labels),
    )


def _outside(scene: Scene, rows: Recorded, frames: list[Real]) -> list[str]:
    """A sentence for each sensor with readings outside the range of the codes."""
    sentences = []
    scales = scene.scales(scene.sensors)
    files = ", ".join(str(one.path) for one in rows.recordings)
    places = [(one.path.name, n) for one in rows.recordings for n in one.numbers]
    own = np.concatenate([one.sensors for one in rows.recordings])
    all_frames = np.concatenate(frames)
    for c, name in enumerate(scene.sensors):
        # A reading of exactly 1 is not outside, because the largest code is right next to it.
        count = int((np.abs(all_frames[:, c]) > 1).sum())
        if not count:
            continue
        row = int(np.abs(all_frames[:, c]).argmax())
        file, number = places[row]
        of_file = f" of {file}" if len(rows.recordings) > 1 else ""
        sentence = (
            f"{files}: column {name!r}: got {count} of {len(own)} readings outside "
            f"{_range(scales[c])}, the furthest {own[row, c]:g} in row {number + 1}{of_file}"
        )
        if count > MOST_OUTSIDE * len(own):
            raise InputError(f"{sentence}, expected at most a tenth; {_remedy(scene, name)}")
        sentences.append(f"{sentence}; the nearest code stands for them")
    return sentences


def _range(scale: Scale) -> str:
    low, high = readings(np.array([[-1.0], [1.0]]), [scale]).ravel()
    return f"{low:g} to {high:g}"


def _remedy(scene: Scene, name: str) -> str:
    part = scene.front_end.converter if scene.front_end else ""
    if part and name in scene.sensors:
        return (
            f"converter {part!r} cannot read beyond it: correct front_end.reference in {scene.path}"
        )
    return (
        f"give {name} a data.scale in {scene.path} that holds it, {{ offset = , factor = }}, or "
        "'auto', which make train works out"
    )


def warn_outside(scene: Scene) -> None:
    """Warn of readings outside the range of the codes, with one line for each sensor."""
    for sentence in scene.vectors().outside:
        warnings.warn(sentence, stacklevel=2)
