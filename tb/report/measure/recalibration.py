"""What is left of the error of a drifted digit after few or many known placements."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from golden.disturbance import Disturbance
from golden.networks.mlp import Real
from golden.recalibration.choice import proposed
from golden.recalibration.fit import Sensitivity, fit
from golden.scene import Scene, load_scene
from golden.scene.scale import readings
from tb.report.measure.table import Cell, Table

SCENE = "digit"
DRIFT = Disturbance(gain=0.03, offset=0.02)
NOISES = (0.0, 0.002)  # V
COUNTS = (3, 4, 6, 8, 10, 20, 40)
DRAWS = 10


def errors(scene: Scene, signals: Real) -> Real:
    """Mean error of each output over the recording, percent, floating point."""
    found: Real = scene.vectors().percent_errors(scene.process_real(signals)).mean(axis=0)
    return found


def left(
    scene: Scene,
    recorded: Sensitivity,
    drifted: Real,
    rows: NDArray[np.intp],
    noise: float,
    rng: np.random.Generator,
) -> Real:
    """What is left after a fit at some rows of the recording, read with noise."""
    vectors = scene.vectors()
    placements = replace(
        vectors,
        inputs=Disturbance(noise).of(drifted[rows], rng),
        targets=vectors.targets[rows],
        scale=vectors.scale[rows],
    )
    return errors(scene, readings(drifted, fit(scene, recorded, placements)))


def recalibration(seed: int) -> Table:
    """Errors before and after, against the number of placements, how they are chosen and noise."""
    scene, rng = load_scene(SCENE), np.random.default_rng(seed)
    vectors, recorded = scene.vectors(), Sensitivity.of(scene)
    nothing = np.zeros((2 * len(scene.sensors),) * 2)
    telling = np.array([row for row, _ in islice(proposed(recorded, nothing), max(COUNTS))])
    drifted = [DRIFT.of(vectors.inputs, rng) for _ in range(DRAWS)]

    def row(placements: int, chosen: str, noise: float | None, found: list[Real]) -> list[Cell]:
        mean = np.mean(found, axis=0)
        millivolts = None if noise is None else 1e3 * noise
        return [placements, chosen, millivolts, *map(float, mean), float(np.mean(mean))]

    rows = [
        row(0, "not drifted", None, [errors(scene, vectors.inputs)]),
        row(0, "drifted", None, [errors(scene, one) for one in drifted]),
    ]
    for noise in NOISES:
        for count in COUNTS:
            at_random = [
                left(scene, recorded, one, rng.permutation(len(one))[:count], noise, rng)
                for one in drifted
            ]
            chosen = [left(scene, recorded, one, telling[:count], noise, rng) for one in drifted]
            rows.append(row(count, "at random", noise, at_random))
            rows.append(row(count, "telling most", noise, chosen))
    return Table(
        "recalibration",
        ["placements", "chosen", "noise mV", *(f"{name} %" for name in scene.outputs), "mean %"],
        rows,
        f"Mean errors of {SCENE} over all recorded rows, floating point, means of {DRAWS} drifts "
        f"of {100 * DRIFT.gain:g} % of the gains and {1e3 * DRIFT.offset:g} mV of the offsets: "
        "before, and after a fit of gain and offset to rows of the recording, read with noise. "
        "'Telling most' are the rows that make recalibrate proposes, in that order.",
    )
