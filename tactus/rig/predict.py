"""Computes what a scene's hardware gives for new readings, and how well its networks know them.

A network gives an output for any reading. If it was trained on nothing similar, the output means
nothing, and the network cannot know that. Two things reveal such a reading: an output beyond the
range of the targets, and readings that the outputs do not explain.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from golden.input_error import InputError, suggest
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from tactus.core.files import check_output, first_line
from tactus.core.finding import fault, refuse
from tactus.core.table import CsvFile, write_csv_file
from tactus.errors import held_out_rows, provenances
from tactus.rig.smooth_map import SmoothMap, fitted, thinned
from tactus.scene import Scene
from tactus.scene.codes import range_lines
from tactus.scene.labels import decided, margins
from tactus.scene.vectors import read_recorded
from tactus.train.split import split_of

# The part of rows like the held-out ones that may be called outside.
FALSE_ALARMS = 0.01
# How far an output may exceed its range, as a part of the range, since a network errs at the ends
# too.
MARGIN = 0.1
# The most rows to which the states are fitted, and with which they are compared. More rows would
# change them very little.
MOST_FITTED, MOST_HELD = 400, 2000
UNLIKE = "unlike every state that trained"


@dataclass(frozen=True)
class TrainedOn:
    """The relation between readings and outputs in the rows that trained a network.

    Equation: a state is a point y in the range of the outputs, and a smooth map f gives the
    readings that belong to it. For readings x, for which the hardware gives the outputs y, the
    residual is ``r = x - f(y)``, with y limited to its range, and the distance is ``sqrt(r' S^-1 r)
    / limit``. S is the mean of r r' on held-out rows. The limit is such that the part FALSE_ALARMS
    of rows like these is farther away.

    low, high, shape (outputs,): The range of the targets in the rows that trained, in the units of
        the outputs.
    states: The map f, from outputs to readings in the units of the sensors.
    whitening, shape (inputs, inputs): The matrix W with ``W' W = S^-1``.
    held, stretches: Number of rows with which the limit was chosen, and how many of these count as
        independent. Rows next to each other in the file may all be near the limit for the same
        reason.
    """

    outputs: Sequence[str]
    low: Real
    high: Real
    states: SmoothMap
    whitening: Real
    limit: float
    held: int
    stretches: int

    @property
    def one_in(self) -> int:
        """One in so many rows like the held-out ones may be called outside."""
        return min(self.stretches + 1, round(1 / FALSE_ALARMS))

    def distances(self, readings: Real, outputs: Real) -> Real:
        """Distances from the states of the outputs, in units of the limit, shape (rows,)."""
        residual = readings - self.states(np.clip(outputs, self.low, self.high))
        return _lengths(residual, self.whitening) / self.limit

    def reasons(self, outputs: Real, distances: Real) -> list[str]:
        """Why each row is outside what was trained on; empty where it is not outside."""
        margin = MARGIN * (self.high - self.low)
        reasons = []
        for row, distance in zip(outputs, distances, strict=True):
            said = [
                f"{name} {'below' if value < low else 'above'} {low if value < low else high:g}"
                for name, value, low, high, over in zip(
                    self.outputs, row, self.low, self.high, margin, strict=True
                )
                if not low - over <= value <= high + over
            ]
            # Of the largest floats the distance is no number.
            said += [] if distance <= 1 else [UNLIKE]
            reasons.append("; ".join(said))
        return reasons


def learnt(
    outputs: Sequence[str],
    readings: Real,
    targets: Real,
    held_readings: Real,
    held_outputs: Real,
    least: Real,
    ends: tuple[Real, Real],
    stretches: int,
) -> TrainedOn:
    """The states that recorded rows show, and how far other rows like these are from them.

    readings, targets, shapes (rows, inputs) and (rows, outputs): Rows to which the states are
        fitted, in the units of the columns.
    held_readings, held_outputs, shapes (held, inputs) and (held, outputs): Rows that took no part
        in the fit, and the outputs of the hardware for them.
    least, shape (inputs,): The least standard deviation of the readings, which is that of their
        codes.
    ends, shape (outputs,): The range of the outputs in the rows that trained.
    stretches: How many of the held-out rows count as independent.
    """
    low, high = ends
    explained = np.clip(held_outputs, low, high)
    states = fitted(targets, readings, explained, held_readings)
    residual = held_readings - states(explained)
    count, inputs = residual.shape
    second = residual.T @ residual / count
    # A few rows are not enough to estimate how the residuals of many sensors depend on each other.
    known = count / (count + inputs)
    second = known * second + np.diag((1 - known) * np.diag(second) + least**2)
    whitening: Real = np.linalg.inv(np.linalg.cholesky(second))
    held = np.sort(_lengths(residual, whitening))
    limit = held[min(count, math.ceil((1 - FALSE_ALARMS) * (count + 1))) - 1]
    # If the map leaves no residual, the limit is the largest error by rounding to codes.
    limit = max(limit, math.sqrt(3) * np.linalg.norm(whitening * least))
    return TrainedOn(outputs, low, high, states, whitening, float(limit), count, stretches)


def _lengths(residual: Real, whitening: Real) -> Real:
    return np.sqrt(((residual @ whitening.T) ** 2).sum(axis=1))


def outputs_of(scene: Scene, codes: Codes) -> Real:
    """The outputs in their units for codes of the hardware.

    Of classes, that which is decided has 1 and the others 0, as in the targets.
    """
    if scene.labels:
        return np.eye(len(scene.labels))[decided(codes)]
    return scene.outputs_in_units(codes)


def trained_on(scene: Scene) -> tuple[TrainedOn, str]:
    """The states that trained the networks of a scene, and in words which rows show them.

    The states are fitted to the rows that ``training.split`` trains with; the other rows show how
    far such rows are from them. The range of the outputs is that of all rows if the networks were
    trained further on all rows, or if it is unknown which rows trained, as with networks from
    elsewhere.
    """
    recorded, split = read_recorded(scene), split_of(scene)
    rows = split.training
    which = f"the {len(rows)} rows that trained"
    everything = held_out_rows(scene) is None
    if everything:
        unknown = provenances(scene) is None
        known = "which of them trained is unknown" if unknown else "all of them trained"
        which = f"all {len(recorded.inputs)} recorded rows; {known}"
    ranged = recorded.targets if everything else recorded.targets[rows]
    held = np.concatenate([split.validation, split.test])
    # Rows that follow each other are one stretch.
    stretches = 1 + int((np.diff(np.sort(held)) > 1).sum())
    held, rows = thinned(held, MOST_HELD), thinned(rows, MOST_FITTED)
    factors = np.array([scale.factor for scale in scene.scales(scene.inputs)])
    states = learnt(
        scene.outputs,
        recorded.inputs[rows],
        recorded.targets[rows],
        recorded.inputs[held],
        outputs_of(scene, scene.twin().core.process(scene.codes_of(recorded.inputs[held]))),
        # The standard deviation of each input within one code.
        factors / (2**SIGNAL.frac * math.sqrt(12)),
        (ranged.min(axis=0), ranged.max(axis=0)),
        len(held) if scene.training.split == "random" else stretches,
    )
    return states, which


LARGEST, LEAD = "largest", "margin"
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
    saturated = scene.twin().core.saturations(samples)
    for layer, counts in saturated.items():
        for row in np.flatnonzero(counts):
            reasons[row] = "; ".join(filter(None, [reasons[row], f"{layer} saturates"]))
    ranges = range_lines(scene, saturated, "rows")
    return Prediction(outputs, codes, distances, reasons, ranges)


def decision_columns(scene: Scene) -> list[str]:
    """The names of the columns of a decision: what the largest output stands for, and its margin.

    Without classes the largest output stands for nothing but itself.
    """
    return [f"{scene.classes}_predicted" if scene.labels else LARGEST, LEAD]


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
    outputs = [f"{name}_predicted" for name in scene.outputs]
    columns = decision_columns(scene) if scene.labels else outputs
    added = [*columns, *CLOSING]
    for name in added:
        if name in recording.names:
            raise InputError(f"{recording.path}: column {name!r} is there already; rename it")
    past, texts = scene.window.past, result_texts(scene, found)
    parts = zip(recording.rows[past:], texts, found.distances, found.reasons, strict=True)
    rows: list[Sequence[object]] = [[*recording.names, *added]]
    rows += [[*row, *[""] * (len(columns) + 1), 1, NO_PAST] for row in recording.rows[:past]]
    rows += [[*row, *own, f"{far:.3f}", int(bool(why)), why] for row, own, far, why in parts]
    write_csv_file(path, rows)


def decimals(factor: float) -> int:
    """The number of decimals needed to distinguish two codes of an output."""
    return max(0, -math.floor(math.log10(math.ldexp(factor, -SIGNAL.frac))))


def check_place(scene: Scene, source: Path, path: Path, force: bool = False) -> None:
    """Refuse to overwrite a file that is read, or one without predictions; see ``FORCE=1``."""

    def predicted(there: Path) -> bool:
        return first_line(there).endswith(",".join(["", *CLOSING]))

    check_output(path, [source, *scene.own_files], own=predicted, force=force)
