"""How well new readings fit the states that a network was trained on.

A network gives an output for any reading. Where nothing like it was trained, the output says
nothing, and the network cannot tell. Two things give such a reading away: an output beyond the
range of the targets, and readings that the outputs do not explain.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from golden.fixed import Codes
from golden.precision import SIGNAL
from golden.real import Real
from golden.rig.smooth_map import SmoothMap, fitted, thinned
from golden.scene import Scene
from golden.scene.vectors import read_recorded
from golden.scene_errors import held_out_rows, told
from golden.training.split import split_of

# Of rows like those that were held out, the part that may be called outside.
FALSE_ALARMS = 0.01
# Of the range of an output, what it may leave the range by: a network errs at the ends too.
MARGIN = 0.1
# Rows that the states are fitted to, and that are held against them: more hardly change them.
MOST_FITTED, MOST_HELD = 400, 2000
UNLIKE = "unlike every state that trained"


@dataclass(frozen=True)
class TrainedOn:
    """What readings go with which outputs, as the rows that trained a network show it.

    Equation: a state is a point y in the range of the outputs, and a smooth map f gives the
    readings that go with it. Readings x with the outputs y of the hardware are ``r = x - f(y)``
    away from their state, y limited to its range, and the distance is
    ``sqrt(r' S^-1 r) / limit``. S is the mean of r r' on held-out rows; the limit is such that the
    part FALSE_ALARMS of rows like these is farther away.

    Parameters
    ----------
    outputs : sequence of str
    low, high : float arrays, shape (outputs,)
        The range of the targets of the rows that trained, in the units of the outputs.
    states : SmoothMap
        f, from outputs to readings in the units of the sensors.
    whitening : float array, shape (inputs, inputs)
        W with ``W' W = S^-1``.
    limit : float
    held, stretches : int
        Rows that the limit was chosen on, and how many of these say something of their own: rows
        beside each other in the file may all be near the limit for one reason.
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
        """Of so many rows like those that were held out, one may be called outside."""
        return min(self.stretches + 1, round(1 / FALSE_ALARMS))

    def distances(self, readings: Real, outputs: Real) -> Real:
        """From the state that the outputs stand for, in units of the limit; shape (rows,)."""
        residual = readings - self.states(np.clip(outputs, self.low, self.high))
        return _lengths(residual, self.whitening) / self.limit

    def reasons(self, outputs: Real, distances: Real) -> list[str]:
        """Why each row, at its distance, is outside what was trained on; empty where it is not."""
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
    """The states that recorded rows show, and how far others of their like are from them.

    Parameters
    ----------
    outputs : sequence of str
    readings, targets : float arrays, shapes (rows, inputs) and (rows, outputs)
        Rows that the states are fitted to, in the units of the columns.
    held_readings, held_outputs : float arrays, shapes (held, inputs) and (held, outputs)
        Rows that took no part in that, and what the hardware gives for them.
    least : float array, shape (inputs,)
        A standard deviation that the readings have at least: that of their codes.
    ends : pair of float arrays, shape (outputs,), optional
        The range of the outputs, where other rows trained too; else that of ``targets``.
    stretches : int, optional
        Stretches of the file that the held-out rows are of; else each row is one.
    """
    low, high = ends or (targets.min(axis=0), targets.max(axis=0))
    explained = np.clip(held_outputs, low, high)
    states = fitted(targets, readings, explained, held_readings)
    residual = held_readings - states(explained)
    count, inputs = residual.shape
    second = residual.T @ residual / count
    # Few rows do not tell how the residuals of many sensors hang together.
    known = count / (count + inputs)
    second = known * second + np.diag((1 - known) * np.diag(second) + least**2)
    whitening: Real = np.linalg.inv(np.linalg.cholesky(second))
    held = np.sort(_lengths(residual, whitening))
    limit = held[min(count, math.ceil((1 - FALSE_ALARMS) * (count + 1))) - 1]
    # Where the map leaves nothing, no farther than rounding to codes alone may be.
    limit = max(limit, math.sqrt(3) * np.linalg.norm(whitening * least))
    known_by = count if stretches is None else stretches
    return TrainedOn(outputs, low, high, states, whitening, float(limit), count, known_by)


def _lengths(residual: Real, whitening: Real) -> Real:
    result: Real = np.sqrt(((residual @ whitening.T) ** 2).sum(axis=1))
    return result


def hardware_outputs(scene: Scene, readings: Real) -> Real:
    """What the hardware of a scene gives for inputs in the units of the sensors, in the units of
    the outputs."""
    codes: Codes = scene.codes_of(readings)
    return scene.outputs_in_units(scene.twin().core.process(codes))


def code_steps(scene: Scene) -> Real:
    """The standard deviation of each input within one code, in the unit of its sensor."""
    factors = np.array([scale.factor for scale in scene.scales(scene.inputs)])
    steps: Real = factors / (2**SIGNAL.frac * math.sqrt(12))
    return steps


def trained_on(scene: Scene) -> tuple[TrainedOn, str]:
    """The states that trained the networks of a scene, and which rows show them, in words.

    They are fitted to the rows that ``training.split`` trains with; the others say how far such
    rows are from them. The range of the outputs is that of all rows for networks that were trained
    on, on all rows, and where it is unknown which trained, as of networks from elsewhere.
    """
    recorded, split = read_recorded(scene), split_of(scene)
    rows = split.training
    which = f"the {len(rows)} rows that trained"
    everything = held_out_rows(scene) is None
    if everything:
        known = "which of them trained is unknown" if told(scene) is None else "all of them trained"
        which = f"all {len(recorded.inputs)} recorded rows; {known}"
    ranged = recorded.targets if everything else recorded.targets[rows]
    held = np.concatenate([split.validation, split.test])
    stretches = None if scene.training.split == "random" else stretches_of(held)
    held, rows = thinned(held, MOST_HELD), thinned(rows, MOST_FITTED)
    states = learnt(
        scene.outputs,
        recorded.inputs[rows],
        recorded.targets[rows],
        recorded.inputs[held],
        hardware_outputs(scene, recorded.inputs[held]),
        code_steps(scene),
        (ranged.min(axis=0), ranged.max(axis=0)),
        stretches,
    )
    return states, which


def stretches_of(rows: Codes) -> int:
    """Stretches of rows that follow each other."""
    return 1 + int((np.diff(np.sort(rows)) > 1).sum())
