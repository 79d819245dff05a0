"""``python -m golden.rig.predict``: what a scene's hardware makes of new readings."""

from __future__ import annotations

import argparse
import csv
import math
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from golden.cli import run, would
from golden.files import check_writable, replace_file, same_file
from golden.input_error import InputError
from golden.networks.mlp import Real
from golden.precision import SIGNAL
from golden.rig.csv_file import CsvFile, read_csv_file
from golden.rig.finding import fault, refuse
from golden.rig.trained_on import TrainedOn, hardware_outputs, trained_on
from golden.scene import Scene, load_scene
from golden.table import suggest

DISTANCE, OUTSIDE, REASON = "distance", "outside", "reason"
NO_PAST = "no whole past"


@dataclass(frozen=True)
class Prediction:
    """Outputs for new readings, of the rows that have a whole past.

    Attributes
    ----------
    outputs : float array, shape (rows, outputs)
        Bit by bit those of the hardware, in the units of the outputs.
    distances : float array, shape (rows,)
    reasons : list of str
        See ``TrainedOn``.
    """

    outputs: Real
    distances: Real
    reasons: list[str]


def readings_of(scene: Scene, recording: CsvFile) -> Real:
    """The sensors' columns of a recording, shape (rows, sensors).

    Raises
    ------
    InputError
        For columns that are missing or hold anything but numbers; all of them are told.
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
    """What the hardware of a scene gives for readings in the units of the sensors.

    Where its networks see past samples, the rows of ``readings`` are one after the other in time.
    """
    seen = scene.window.frames(readings)
    outputs = hardware_outputs(scene, seen)
    distances = known.distances(seen, outputs)
    return Prediction(outputs, distances, known.reasons(outputs, distances))


def write_prediction(scene: Scene, recording: CsvFile, found: Prediction, path: Path) -> None:
    """Write every column of the recording as it stands, and behind them what was found.

    A row without a whole past has no outputs and no distance; it is marked as outside.

    Raises
    ------
    InputError
        When the recording has a column of such a name.
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
    """Decimals that tell two codes of an output apart."""
    return max(0, -math.floor(math.log10(math.ldexp(factor, -SIGNAL.frac))))


def check_place(scene: Scene, source: Path, path: Path) -> None:
    """Refuse to write over what is read.

    Raises
    ------
    InputError
    """
    if any(same_file(path, file) for file in [source, *scene.files]):
        raise InputError(f"TO={path}: is read, expected another file")
    check_writable([path])


def main() -> None:
    parser = argparse.ArgumentParser(prog="make predict", description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("csv")
    parser.add_argument("to")
    arguments = parser.parse_args()
    for key, given in (("CSV", arguments.csv), ("TO", arguments.to)):
        if not given:
            raise InputError(f"{key}=: missing, expected a .csv file")
    scene = load_scene(arguments.scene)
    source, path = Path(arguments.csv), Path(arguments.to)
    check_place(scene, source, path)
    recording = read_csv_file(source)
    readings = readings_of(scene, recording)
    past = scene.window.past
    if len(readings) <= past:
        raise InputError(
            f"{source}: got {len(readings)} rows, expected more than the {past} that data.window "
            f"of {scene.path} reaches back"
        )
    would(f"write {path}")
    known, which = trained_on(scene)
    found = predict(scene, readings, known)
    write_prediction(scene, recording, found, path)
    for name, values in zip(scene.outputs, found.outputs.T, strict=True):
        unit = f" {scene.units[name]}" if name in scene.units else ""
        print(f"{name}: {values.min():g} to {values.max():g}{unit}")
    outside = sum(map(bool, found.reasons))
    if past:
        print(f"the first {past} of {len(readings)} rows have no whole past and no outputs")
    print(f"{outside} of {len(found.reasons)} rows are outside {which}")
    print(f"of rows like the {known.held} that set the limit about 1 in {known.one_in} is too")
    print(f"wrote {path}")


if __name__ == "__main__":
    sys.exit(run(main))
