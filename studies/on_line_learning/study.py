"""What LMS in the words of an engine leaves of a drift, and of what is no drift."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from golden.engine.integer_network import evaluate
from golden.engine.quantise import integer_networks
from golden.learning.corrected import Corrected
from golden.learning.gradient import Lesson, constants, equation, lms_step, start
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from golden.numbers.units import FULL_SCALE, LOAD_G, WIDTH_MM
from studies.physics.digit_sensors import (
    COLUMNS,
    RECORDED,
    SENSORS,
    fit_sensors,
    loads_from_codes,
    read_sensors,
)
from tactus.core.table import read_table
from tactus.physics.beam import Beam, StrainSensor
from tactus.recalibration.fit import fit
from tactus.recalibration.folder import corrected
from tactus.recalibration.outlook import proposed
from tactus.recalibration.sensitivity import Placements, Sensitivity
from tactus.report.measure.table import Cell
from tactus.scene import Vectors, load_scene
from tactus.scene.disturbance import Disturbance

SEED = 1
SCENE = load_scene("digit")
DRIFT = Disturbance(gain=0.03, offset=0.02)
NOISES = (0.0, 0.001, 0.002)  # V
COUNTS = (4, 8, 12, 20)
PASSES = 400
LIGHT_G, LEAST_G = (3.0, 6.0), 6.0
# For each width of the recording one that is in none of its rows.
WIDTHS_MM = {12.7: 19.05, 25.4: 31.75, 38.1: 44.45, 50.8: 44.45}


@dataclass(frozen=True)
class Draws:
    """Recordings as several changed rigs read them, and the placements that are shown.

    readings, shape (draws, rows, sensors): The whole recording, without noise.
    noisy, shape (draws, placements, sensors): What is read at the rows that are shown.
    """

    vectors: Vectors
    noise: float
    readings: Real
    shown: NDArray[np.intp]
    noisy: Real

    def worst(self, outputs: Sequence[Codes]) -> Real:
        """The largest error of each output on rows that were not shown, in percent."""
        errors = [self.vectors.percent_errors(SIGNAL.to_real(one)) for one in outputs]
        return np.array([np.delete(one, self.shown, axis=0).max(axis=0) for one in errors])

    @property
    def codes(self) -> Codes:
        """What is read without noise."""
        return SIGNAL.quantise(self.readings)[0]


@cache
def placements(noise: float, count: int) -> NDArray[np.intp]:
    """The rows of the placements that make recalibrate proposes."""
    sensitivity = Sensitivity.of(SCENE, np.full(len(SCENE.sensors), noise))
    return np.array([one.row for one in islice(proposed(sensitivity), count)])


def taught() -> Corrected:
    """The networks of the scene behind gains and offsets."""
    recorded = Sensitivity.of(SCENE, np.zeros(len(SCENE.sensors)))
    return Corrected.of(SCENE.mlps(), recorded.gain, recorded.offset)


def drifted(noise: float, count: int) -> Draws:
    """Ten drifts of gains and offsets."""
    vectors, shown = SCENE.vectors(), placements(noise, max(COUNTS))
    readings, noisy = [], []
    for number in range(10):
        rng = np.random.default_rng([SEED, number])
        readings.append(DRIFT.of(vectors.inputs, rng))
        read = readings[-1][shown]
        noisy.append((read + noise * rng.standard_normal(read.shape))[:count])
    return Draws(vectors, noise, np.array(readings), shown[:count], np.array(noisy))


@dataclass(frozen=True)
class Change:
    """What is no drift: another gauge on the beam, or other loads."""

    name: str
    gauge: Callable[[StrainSensor], StrainSensor] = lambda gauge: gauge
    loads: Callable[[Real], Real] = lambda codes: codes

    def of(self, vectors: Vectors) -> Vectors:
        """The recording, with what the theory of the beam adds to it.

        A sensor whose fitted place is not on the beam stays as it is.
        """
        sensors = fit_sensors(read_table(RECORDED, [*SENSORS, *COLUMNS]), Beam())
        new = [self.gauge(one) if one.position >= 0 else one for one in sensors]
        targets = self.loads(vectors.targets)
        before, after = (
            read_sensors(those, loads_from_codes(codes, those[0].beam))
            for those, codes in ((sensors, vectors.targets), (new, targets))
        )
        # The error of some outputs is relative to the target.
        scale = np.where(vectors.scale == vectors.targets, targets, vectors.scale)
        moved = np.clip(vectors.inputs + after - before, -1, 1)
        return replace(vectors.with_inputs(moved), targets=targets, scale=scale)


def thicker(factor: float) -> Callable[[StrainSensor], StrainSensor]:
    return lambda one: replace(one, beam=replace(one.beam, thickness=factor * one.beam.thickness))


def moved(by: float) -> Callable[[StrainSensor], StrainSensor]:
    return lambda one: replace(one, position=one.position + by)


def other_widths(codes: Real) -> Real:
    width = np.round(codes[:, 2] / FULL_SCALE * WIDTH_MM, 2)
    new = np.array([WIDTHS_MM[float(one)] for one in width]) / WIDTH_MM * FULL_SCALE
    return np.column_stack([codes[:, :2], new, codes[:, 3]])


def light(codes: Real) -> Real:
    grams = np.interp(codes[:, 0] / FULL_SCALE * LOAD_G, (LEAST_G, LOAD_G), LIGHT_G)
    return np.column_stack([grams / LOAD_G * FULL_SCALE, codes[:, 1:]])


CHANGES = (
    Change("nothing"),
    Change("a beam 5 % thicker", thicker(1.05)),
    Change("a beam 20 % thicker", thicker(1.2)),
    Change("gauges moved by 2 mm", moved(0.002)),
    Change("gauges moved by 10 mm", moved(0.01)),
    Change("widths between the trained ones", loads=other_widths),
    Change("loads of 3 to 6 g", loads=light),
)


def changed(number: int) -> Draws:
    """Five readings of a changed rig."""
    noise, shown = NOISES[1], placements(NOISES[1], max(COUNTS))
    vectors = CHANGES[number].of(SCENE.vectors())
    rng = np.random.default_rng([SEED, number])
    by = noise * rng.standard_normal((5, len(shown), len(SCENE.sensors)))
    readings = np.repeat(vectors.inputs[np.newaxis], 5, axis=0)
    return Draws(vectors, noise, readings, shown, vectors.inputs[shown] + by)


def uncorrected(drawn: Draws) -> Real:
    networks = taught().networks
    return drawn.worst([evaluate(networks, one) for one in drawn.codes])


def recalibrated(drawn: Draws) -> Real:
    """What make recalibrate reaches on a computer."""
    vectors, rows = drawn.vectors, drawn.shown
    sensitivity = Sensitivity.of(SCENE, np.full(len(SCENE.sensors), drawn.noise))
    outputs = []
    for noisy, codes in zip(drawn.noisy, drawn.codes, strict=True):
        known = Placements(noisy, vectors.targets[rows], vectors.scale[rows], np.ones(len(rows)))
        mlps = corrected(SCENE, sensitivity.correction(fit(sensitivity, known).theta))
        outputs.append(evaluate(integer_networks("cascade", mlps), codes))
    return drawn.worst(outputs)


def learned(drawn: Draws) -> Real:
    """What an engine reaches with LMS."""
    networks, vectors = taught(), SCENE.vectors()
    steps = constants(networks, vectors.codes, SIGNAL.quantise(vectors.targets)[0])
    known = SIGNAL.quantise(drawn.vectors.targets)[0][drawn.shown]
    targets = np.repeat(known[np.newaxis], len(drawn.noisy), axis=0)
    lesson = Lesson(SIGNAL.quantise(drawn.noisy)[0], targets)
    theta = start(lesson, networks)
    for placement in list(range(len(lesson))) * PASSES:
        for output in range(networks.outputs):
            found = equation(networks, lesson, theta, placement, output)
            theta, _ = lms_step(theta, found, *steps[output])
    return drawn.worst(
        [
            networks.process(np.broadcast_to(one, (len(rows), len(one))), rows)
            for one, rows in zip(theta, drawn.codes, strict=True)
        ]
    )


CORRECTIONS = {
    "no correction": uncorrected,
    "make recalibrate": recalibrated,
    "LMS, constant step": learned,
}


def rows() -> Iterator[dict[str, Cell]]:
    """The worst errors after each change and correction: median, least and largest of the draws."""
    for count in COUNTS:
        for noise in NOISES:
            yield from _rows("drift", drifted(noise, count))
    for number, change in enumerate(CHANGES):
        yield from _rows(change.name, changed(number))


def _rows(change: str, drawn: Draws) -> Iterator[dict[str, Cell]]:
    for name, correction in CORRECTIONS.items():
        worst = correction(drawn)
        found: dict[str, Cell] = {
            "change": change,
            "correction": name,
            "noise mV": 1e3 * drawn.noise,
            "placements": len(drawn.shown),
        }
        for k, output in enumerate(SCENE.outputs):
            found[f"{output} %"] = round(float(np.median(worst[:, k])), 4)
            found[f"{output} from %"] = round(float(worst[:, k].min()), 4)
            found[f"{output} to %"] = round(float(worst[:, k].max()), 4)
        yield found
