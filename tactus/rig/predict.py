"""Computes what a scene's hardware gives for new readings."""

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from golden.input_error import InputError, suggest
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from tactus.core.files import check_output, first_line, replace_file
from tactus.core.finding import fault, refuse
from tactus.core.table import CsvFile
from tactus.rig.trained_on import TrainedOn, outputs_of
from tactus.scene import Scene
from tactus.scene.codes import hidden_saturations, range_lines
from tactus.scene.labels import decided, margins

LARGEST, MARGIN = "largest", "margin"
DISTANCE, OUTSIDE, REASON = "distance", "outside", "reason"
# The last columns of every prediction.
CLOSING = (DISTANCE, OUTSIDE, REASON)
NO_PAST = "no whole past"


@dataclass(frozen=True)
class Prediction:
    """Outputs for new readings, of the rows that have a complete past.

    outputs, shape (rows, outputs): The same, bit by bit, as those of the hardware, in the units of
        the outputs. Of classes, 1 for that which is decided and 0 for the others.
    codes, shape (rows, outputs): The outputs as codes.
    distances: shape (rows,).
    reasons: See ``TrainedOn``; also each hidden layer that saturates.
    ranges: The range of each hidden layer in which saturation would be an error, and what
        saturates.
    """

    outputs: Real
    codes: Codes
    distances: Real
    reasons: list[str]
    ranges: list[str]


def readings_of(scene: Scene, recording: CsvFile) -> Real:
    """The sensors' columns of a recording, shape (rows, sensors)."""
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
    samples = scene.codes_of(seen)
    codes = scene.twin().core.process(samples)
    outputs = outputs_of(scene, codes)
    distances = known.distances(seen, outputs)
    reasons = known.reasons(outputs, distances)
    saturated = hidden_saturations(scene, samples)
    for layer, counts in saturated.items():
        for row in np.flatnonzero(counts):
            reasons[row] = "; ".join(filter(None, [reasons[row], f"{layer} saturates"]))
    ranges = range_lines(scene, saturated, "rows")
    return Prediction(outputs, codes, distances, reasons, ranges)


def decision_columns(scene: Scene) -> list[str]:
    """The names of the columns of a decision: what the largest output stands for, and its margin.

    Without classes the largest output stands for nothing but itself.
    """
    return [f"{scene.classes}_predicted" if scene.labels else LARGEST, MARGIN]


def result_columns(scene: Scene) -> list[str]:
    """The names of the columns of results: an output each, or the class and its margin."""
    if scene.labels:
        return decision_columns(scene)
    return [f"{name}_predicted" for name in scene.outputs]


def result_texts(scene: Scene, found: Prediction) -> list[list[str]]:
    """What stands in the columns of results, row by row.

    The margin says by how many codes the output of the class exceeds that of any other class.
    """
    if scene.labels:
        numbers, by = decided(found.codes), margins(found.codes)
        return [[scene.labels[n], str(m)] for n, m in zip(numbers, by, strict=True)]
    places = [decimals(scale.factor) for scale in scene.scales(scene.outputs)]
    # Adding 0 turns -0 into 0.
    return [
        [f"{v.round(d) + 0:.{d}f}" for v, d in zip(outputs, places, strict=True)]
        for outputs in found.outputs
    ]


def write_prediction(scene: Scene, recording: CsvFile, found: Prediction, path: Path) -> None:
    """Write every column of the recording unchanged, and behind them the columns of results.

    A row without a complete past has no outputs and no distance, and is marked as outside.
    """
    columns = result_columns(scene)
    added = [*columns, *CLOSING]
    for name in added:
        if name in recording.names:
            raise InputError(f"{recording.path}: column {name!r} is there already; rename it")
    results = result_texts(scene, found)
    with replace_file(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([*recording.names, *added])
        past = scene.window.past
        for row in recording.rows[:past]:
            writer.writerow([*row, *[""] * (len(columns) + 1), 1, NO_PAST])
        for row, texts, distance, reason in zip(
            recording.rows[past:], results, found.distances, found.reasons, strict=True
        ):
            writer.writerow([*row, *texts, f"{distance:.3f}", int(bool(reason)), reason])


def decimals(factor: float) -> int:
    """The number of decimals needed to distinguish two codes of an output."""
    return max(0, -math.floor(math.log10(math.ldexp(factor, -SIGNAL.frac))))


def check_place(scene: Scene, source: Path, path: Path, force: bool = False) -> None:
    """Refuse to overwrite a file that is read, or one without predictions; see ``FORCE=1``."""

    def predicted(there: Path) -> bool:
        return first_line(there).endswith(",".join(["", *CLOSING]))

    check_output(path, [source, *scene.own_files], own=predicted, force=force)
