"""What gains and offsets can learn beyond drift: another beam, moved gauges, new loads.

The theory of the beam says by how much the readings change; this is added to the recorded readings.
Learning is LMS with a constant step, as an engine computes it, with the networks of the scene.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np

from golden.physics.beam import Beam
from golden.physics.digit_data import RECORDED, SENSORS
from golden.physics.strain_sensor import COLUMNS, StrainSensor, fit_sensors, loads_from_codes
from golden.physics.strain_sensor import read_sensors as read
from golden.real import Real
from golden.recalibration.choice import proposed
from golden.recalibration.sensitivity import Sensitivity
from golden.scene import Vectors, load_scene
from golden.table import read_table
from golden.units import FULL_SCALE, LOAD_G, WIDTH_MM
from tb.report.measure.on_line_learning import (
    COMPUTER,
    LMS,
    NONE,
    RULES,
    SCENE,
    Draws,
    learned,
    recalibrated,
    shipped,
    uncorrected,
)
from tb.report.measure.table import Cell, Table

NOISE = 0.001  # V
SHOWN = 20
DRAWS = 5
LIGHT_G = (3.0, 6.0)
LEAST_G = 6.0
# For each width of the recording one that is in none of its rows.
WIDTHS_MM = {12.7: 19.05, 25.4: 31.75, 38.1: 44.45, 50.8: 44.45}

NOTES = {
    "beyond_drift": f"The figures are errors of {SCENE} in percent on the rows that were not "
    "shown: "
    f"the worst row of each output, as the median over {DRAWS} readings with a noise of "
    f"{1e3 * NOISE:g} mV ('from' and 'to' are the least and the largest). {SHOWN} placements are "
    "shown, those that make recalibrate proposes. The readings are the recorded ones and what the "
    "theory of the beam adds to them. Sensor 4 reads the load alone, so a change of the beam or of "
    "its gauges does not reach it. LMS is bit-true; both corrections are gains and offsets of the "
    "sensors, and the networks stay as they are.",
}


@dataclass(frozen=True)
class Change:
    """Something that is no drift.

    gauge: A gauge on the beam after the change.
    loads: The coded loads, shape (rows, 4), after the change.
    """

    name: str
    gauge: Callable[[StrainSensor], StrainSensor] = lambda gauge: gauge
    loads: Callable[[Real], Real] = lambda codes: codes


def _thicker(factor: float) -> Callable[[StrainSensor], StrainSensor]:
    def changed(gauge: StrainSensor) -> StrainSensor:
        beam = replace(gauge.beam, thickness=factor * gauge.beam.thickness)
        return replace(gauge, beam=beam)

    return changed


def _moved(by: float) -> Callable[[StrainSensor], StrainSensor]:
    return lambda gauge: replace(gauge, position=gauge.position + by)


def _other_widths(codes: Real) -> Real:
    width = np.round(codes[:, 2] / FULL_SCALE * WIDTH_MM, 2)
    new = np.array([WIDTHS_MM[float(one)] for one in width]) / WIDTH_MM * FULL_SCALE
    return np.column_stack([codes[:, :2], new, codes[:, 3]])


def _light(codes: Real) -> Real:
    grams = np.interp(codes[:, 0] / FULL_SCALE * LOAD_G, (LEAST_G, LOAD_G), LIGHT_G)
    return np.column_stack([grams / LOAD_G * FULL_SCALE, codes[:, 1:]])


CHANGES = (
    Change("nothing"),
    Change("a beam 5 % thicker", _thicker(1.05)),
    Change("a beam 20 % thicker", _thicker(1.2)),
    Change("gauges moved by 2 mm", _moved(0.002)),
    Change("gauges moved by 10 mm", _moved(0.01)),
    Change("widths between the trained ones", loads=_other_widths),
    Change("loads of 3 to 6 g", loads=_light),
)


def changed(change: Change, vectors: Vectors) -> Vectors:
    """The recording after a change: what sensors read, and what the loads are.

    A sensor whose fitted place is not on the beam stays as it is.
    """
    sensors = fit_sensors(read_table(RECORDED, [*SENSORS, *COLUMNS]), Beam())
    new = [change.gauge(one) if one.position >= 0 else one for one in sensors]
    targets = change.loads(vectors.targets)
    before, after = (
        read(those, loads_from_codes(codes, those[0].beam))
        for those, codes in ((sensors, vectors.targets), (new, targets))
    )
    # The error of some outputs is relative to the target.
    scale = np.where(vectors.scale == vectors.targets, targets, vectors.scale)
    moved = np.clip(vectors.inputs + after - before, -1, 1)
    return replace(vectors.with_inputs(moved), targets=targets, scale=scale)


def draws(change: Change, seed: int) -> Draws:
    """The placements of a change, read several times with noise."""
    scene = load_scene(SCENE)
    vectors = changed(change, scene.vectors())
    recorded = Sensitivity.of(scene, np.full(len(scene.sensors), NOISE))
    rows = np.array([one.row for one in islice(proposed(recorded), SHOWN)])
    rng = np.random.default_rng([seed, CHANGES.index(change)])
    noise = NOISE * rng.standard_normal((DRAWS, SHOWN, len(scene.sensors)))
    return Draws(
        scene,
        vectors,
        shipped(scene, np.full(DRAWS, NOISE)),
        np.repeat(vectors.inputs[np.newaxis], DRAWS, axis=0),
        np.repeat(rows[np.newaxis], DRAWS, axis=0),
        vectors.inputs[rows] + noise,
    )


def corrected(drawn: Draws) -> dict[str, Real]:
    """The worst errors with each correction, shape (draws, outputs)."""
    (lms,) = (rule for rule in RULES if rule.name == LMS)
    return {
        NONE: uncorrected(drawn, SHOWN),
        COMPUTER: recalibrated(drawn, SHOWN),
        LMS: learned(lms, drawn, SHOWN).worst,
    }


def beyond_drift(seed: int) -> Table:
    """The errors after each change, without a correction and with those that learn."""
    outputs: Sequence[str] = load_scene(SCENE).outputs
    rows: list[list[Cell]] = []
    for change in CHANGES:
        for name, worst in corrected(draws(change, seed)).items():
            ends = np.stack([worst.min(axis=0), worst.max(axis=0)], axis=1).ravel()
            medians = np.median(worst, axis=0)
            rows.append([change.name, name, *map(float, medians), *map(float, ends)])
    return Table(
        "beyond_drift",
        [
            "change",
            "correction",
            *(f"{name} %" for name in outputs),
            *(f"{name} {end} %" for name in outputs for end in ("from", "to")),
        ],
        rows,
        NOTES["beyond_drift"],
    )
