"""How near new readings are to those that a network was trained on.

A network gives an output for any reading. Where nothing like it was trained, the output says
nothing, and the network cannot tell.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from golden.errors import held_out_rows, told
from golden.networks.mlp import Real
from golden.scene import Scene
from golden.scene.vectors import read_recorded
from golden.training.split import split_of


@dataclass(frozen=True)
class TrainedOn:
    """Readings that trained a network, and how far new ones are from them.

    A row is outside where a sensor leaves its range in these rows, or where the nearest of them is
    farther than any of them is from its own nearest: sensors that are each within their range but
    never were so together. Distances are Euclidean, each sensor in standard deviations of its own.

    Parameters
    ----------
    sensors : sequence of str
        Or samples of them, where a network sees past ones.
    readings : float array, shape (rows, sensors)
        In the units of the sensors; two rows or more.
    """

    sensors: Sequence[str]
    readings: Real

    def __post_init__(self) -> None:
        if len(self.readings) < 2:
            raise ValueError(f"got {len(self.readings)} rows that trained, expected 2 or more")

    @property
    def _unit(self) -> Real:
        spread: Real = self.readings.std(axis=0)
        return np.where(spread > 0, spread, 1.0)

    def distances(self, readings: Real) -> Real:
        """From each row to the nearest that trained, in units of the largest among these."""
        tree = KDTree(self.readings / self._unit)
        largest = tree.query(self.readings / self._unit, k=2)[0][:, 1].max()
        nearest: Real = tree.query(readings / self._unit)[0]
        # Rows that trained may all stand there twice.
        return nearest / largest if largest else np.where(nearest > 0, np.inf, 0.0)

    def reasons(self, readings: Real, distances: Real) -> list[str]:
        """Why each row, at its distance, is outside what was trained on; empty where it is not."""
        low, high = self.readings.min(axis=0), self.readings.max(axis=0)
        reasons = []
        for row, distance in zip(readings, distances, strict=True):
            said = [
                f"{name} {'below' if value < a else 'above'} {a if value < a else b:g}"
                for name, value, a, b in zip(self.sensors, row, low, high, strict=True)
                if not a <= value <= b
            ]
            said += ["far from every row that trained"] if distance > 1 else []
            reasons.append("; ".join(said))
        return reasons


def trained_on(scene: Scene) -> tuple[TrainedOn, str]:
    """The rows that trained the networks of a scene, and which these are, in words.

    Of networks that were trained on, on all rows, and where it is unknown, as of networks from
    elsewhere, they are all recorded rows.
    """
    recorded = read_recorded(scene).inputs
    if held_out_rows(scene) is None:
        known = "which of them trained is unknown" if told(scene) is None else "all of them trained"
        return TrainedOn(scene.inputs, recorded), f"all {len(recorded)} recorded rows; {known}"
    rows = split_of(scene).training
    return TrainedOn(scene.inputs, recorded[rows]), f"the {len(rows)} rows that trained"
