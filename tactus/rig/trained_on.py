"""Measures how well new readings fit the states on which a network was trained.

A network gives an output for any reading. If it was trained on nothing similar, the output means
nothing, and the network cannot know that. Two things reveal such a reading: an output beyond the
range of the targets, and readings that the outputs do not explain.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from tactus.errors import held_out_rows, provenances
from tactus.rig.smooth_map import SmoothMap, fitted, thinned
from tactus.scene import Scene
from tactus.scene.labels import decided
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
            said += [UNLIKE] if distance > 1 else []
            reasons.append("; ".join(said))
        return reasons


def learnt(
    outputs: Sequence[str],
    readings: Real,
    targets: Real,
    held_readings: Real,
    held_outputs: Real,
    least: Real,
    ends: tuple[Real, Real] | None = None,
    stretches: int | None = None,
) -> TrainedOn:
    """The states that recorded rows show, and how far other rows like these are from them.

    readings, targets, shapes (rows, inputs) and (rows, outputs): Rows to which the states are
        fitted, in the units of the columns.
    held_readings, held_outputs, shapes (held, inputs) and (held, outputs): Rows that took no part
        in the fit, and the outputs of the hardware for them.
    least, shape (inputs,): The least standard deviation of the readings, which is that of their
        codes.
    ends, shape (outputs,): The range of the outputs, where other rows trained too; by default that
        of ``targets``.
    stretches: Number of stretches of the file from which the held-out rows come; by default each
        row counts.
    """
    low, high = ends or (targets.min(axis=0), targets.max(axis=0))
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
    known_by = count if stretches is None else stretches
    return TrainedOn(outputs, low, high, states, whitening, float(limit), count, known_by)


def _lengths(residual: Real, whitening: Real) -> Real:
    return np.sqrt(((residual @ whitening.T) ** 2).sum(axis=1))


def hardware_outputs(scene: Scene, readings: Real) -> Real:
    """The outputs of a scene's hardware for its inputs, both in their own units.

    Of classes, that which is decided has 1 and the others 0, as in the targets.
    """
    codes: Codes = scene.codes_of(readings)
    return outputs_of(scene, scene.twin().core.process(codes))


def outputs_of(scene: Scene, codes: Codes) -> Real:
    """The outputs for codes of the hardware; see ``hardware_outputs``."""
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
        hardware_outputs(scene, recorded.inputs[held]),
        # The standard deviation of each input within one code.
        factors / (2**SIGNAL.frac * math.sqrt(12)),
        (ranged.min(axis=0), ranged.max(axis=0)),
        None if scene.training.split == "random" else stretches,
    )
    return states, which
