"""Computes what a scene's hardware gives for new readings."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from golden.files import check_writable, replace_file, same_file
from golden.finding import fault, refuse
from golden.input_error import InputError
from golden.precision import SIGNAL
from golden.real import Real
from golden.rig.trained_on import TrainedOn, hardware_outputs
from golden.scene import Scene
from golden.scene.saturation import hidden_saturations, range_lines
from golden.table import CsvFile, suggest

DISTANCE, OUTSIDE, REASON = "distance", "outside", "reason"
NO_PAST = "no whole past"


@dataclass(frozen=True)
class Prediction:
    """Outputs for new readings, of the rows that have a complete past.

    Attributes
    ----------
    outputs : float array, shape (rows, outputs)
        The same, bit by bit, as those of the hardware, in the units of the outputs.
    distances : float array, shape (rows,)
    reasons : list of str
        See ``TrainedOn``; also each hidden layer that saturates.
    ranges : list of str
        The range of each hidden layer in which saturation would be an error, and what saturates.
    """

    outputs: Real
    distances: Real
    reasons: list[str]
    ranges: list[str]


def readings_of(scene: Scene, recording: CsvFile) -> Real:
    """The sensors' columns of a recording, shape (rows, sensors).

    Raises
    ------
    InputError
        For all columns that are missing or hold anything but numbers, in one message.
    """
    found = []
    columns = []
    for name in scene.sensors:
        if name not in recording.names:
            hint = suggest(name, recording.names)
            found.append(f"{recording.path}: no column {name!r}, which is a sensor{hint}")
            continue
        column = recording.column(name)
        columns.append(column.values)
        found.append(column.fault(recording.path))
    refuse([fault(text) for text in found if text])
    return np.column_stack(columns)


def predict(scene: Scene, readings: Real, known: TrainedOn) -> Prediction:
    """The outputs of a scene's hardware for readings in the units of the sensors.

    Where its networks read past samples, the rows of ``readings`` must follow each other in time.
    """
    seen = scene.window.frames(readings)
    outputs = hardware_outputs(scene, seen)
    distances = known.distances(seen, outputs)
    reasons, codes = known.reasons(outputs, distances), scene.codes_of(seen)
    for layer, counts in hidden_saturations(scene, codes):
        for row in np.flatnonzero(counts):
            reasons[row] = "; ".join(filter(None, [reasons[row], f"{layer} saturates"]))
    return Prediction(outputs, distances, reasons, range_lines(scene, codes, "rows"))


def write_prediction(scene: Scene, recording: CsvFile, found: Prediction, path: Path) -> None:
    """Write every column of the recording unchanged, and behind them the columns of results.

    A row without a complete past has no outputs and no distance, and is marked as outside.

    Raises
    ------
    InputError
        When the recording already has a column with the name of a result.
    """
    added = [*(f"{name}_predicted" for name in scene.outputs), DISTANCE, OUTSIDE, REASON]
    for name in added:
        if name in recording.names:
            raise InputError(f"{recording.path}: column {name!r} is there already; rename it")
    places = [decimals(scale.factor) for scale in scene.scales(scene.outputs)]
    with replace_file(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([*recording.names, *added])
        past = scene.window.past
        for row in recording.rows[:past]:
            writer.writerow([*row, *[""] * (len(scene.outputs) + 1), 1, NO_PAST])
        for row, outputs, distance, reason in zip(
            recording.rows[past:], found.outputs, found.distances, found.reasons, strict=True
        ):
            # Adding 0 turns -0 into 0.
            texts = [f"{v.round(d) + 0:.{d}f}" for v, d in zip(outputs, places, strict=True)]
            writer.writerow([*row, *texts, f"{distance:.3f}", int(bool(reason)), reason])


def decimals(factor: float) -> int:
    """The number of decimals needed to distinguish two codes of an output."""
    return max(0, -math.floor(math.log10(math.ldexp(factor, -SIGNAL.frac))))


def check_place(scene: Scene, source: Path, path: Path) -> None:
    """Refuse to overwrite a file that is read.

    Raises
    ------
    InputError
    """
    if any(same_file(path, file) for file in [source, *scene.files]):
        raise InputError(f"TO={path}: is read, expected another file")
    check_writable([path])
