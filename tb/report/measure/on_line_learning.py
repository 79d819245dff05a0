"""What is left of a drift when an engine learns from placements, by rule, beside recalibration.

Everything is computed in the words of an engine (``golden.learning``), on the same drifts, the same
placements and the same noise of readings for every rule and for ``make recalibrate``.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import islice
from typing import Protocol

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray

from golden.disturbance import Disturbance
from golden.engine.integer_network import evaluate
from golden.engine.quantise import integer_networks
from golden.fixed import Codes, Fix
from golden.learning.conjugate import Conjugate
from golden.learning.corrected import Corrected
from golden.learning.costs import luts
from golden.learning.gradient import LENGTH, Gradient, constants
from golden.learning.lesson import Lesson, by_differences
from golden.learning.noise import Noise
from golden.learning.output_layers import OutputLayers
from golden.learning.perturbation import OVER_R, Perturbation
from golden.learning.recursive import SQUARE, Recursive
from golden.learning.unit import Unit
from golden.precision import SIGNAL
from golden.real import Real
from golden.recalibration.choice import proposed
from golden.recalibration.fit import fit
from golden.recalibration.folder import corrected
from golden.recalibration.placements import Placements
from golden.recalibration.sensitivity import Sensitivity
from golden.scene import Scene, Vectors, load_scene
from tb.report.measure.table import Cell, Table

SCENE = "digit"
DRIFT = Disturbance(gain=0.03, offset=0.02)
NOISES = (0.0, 0.001, 0.002)  # V
COUNTS = (4, 8, 12, 20)
DRAWS = 10
CLOCK = 64e6
# The square of the damping of a Kaczmarz step, in r^2: chosen on other drifts.
DAMPING = 16
# The squared error that drift leaves to the best output layer, in squares of the range.
OUTPUT_LAYER = 1e-4
# A hidden sum saturates where tanh is flat, in every engine.
AS_EVER = ("hidden sum",)

NOTES = {
    "on_line_learning": f"The figures are errors of {SCENE} in percent on the rows of the "
    "recording that were not shown: for each drift the worst row of each output, as the median "
    f"over {DRAWS} drifts of {100 * DRIFT.gain:g} % of the gains and {1e3 * DRIFT.offset:g} mV of "
    "the offsets ('from' and 'to' are the least and the largest). Everything is bit-true, in the "
    "words of an engine. The placements are those that make recalibrate proposes, in its order, "
    "each read once with noise. 'Times' is the largest of the four ratios to the medians of make "
    "recalibrate. 'Steps' are those of one pass over one placement, and 'clocks' those of all "
    "passes on one multiplier, where each sum waits for its words. 'Words' are those of the "
    "memory that hold what is learned and kept, and 'LUTs' an estimate of the whole engine. 'Sum "
    "bits' are those of the largest sum. 'Does not fit' is the part of the words of a name that "
    "saturated, or of the steps that were refused.",
}


class Learner(Protocol):
    """A rule with its constants."""

    def learn(self, lesson: Lesson, passes: int, unit: Unit) -> Codes:
        """Theta after so many passes, shape (drifts, 2 sensors)."""


@dataclass(frozen=True)
class Setting:
    """What the rules are given: the networks, and constants of each drift.

    readings, shape (drifts,): Standard deviation of the noise of a reading.
    steps, shape (outputs,): The constant step of each output.
    """

    taught: Corrected
    noise: Noise
    readings: Real
    steps: Codes

    def squares(self, frac: int) -> Codes:
        """r^2 with so many fraction bits."""
        return self.noise.squares(self.readings, Fix(62, frac))

    def gradient(self, halvings: int, **other: object) -> Gradient:
        damping = self.noise.squares(self.readings, LENGTH, DAMPING)
        return Gradient(self.taught, halvings, damping, **other)  # type: ignore[arg-type]

    def constant(self) -> Gradient:
        """LMS whose constant step is half of what no equation of the recording overshoots with."""
        return self.gradient(0, constant=self.steps)

    def recursive(self, width: int, root: bool) -> Recursive:
        return Recursive(self.taught, self.squares(SQUARE), width, root)

    def conjugate(self, width: int) -> Conjugate:
        return Conjugate(self.taught, self.squares(SQUARE), width)

    def perturbation(self, shift: int) -> Perturbation:
        over = 1 / np.sqrt(Fix(62, SQUARE).to_real(self.squares(SQUARE)))
        return Perturbation(self.taught, Fix(18, OVER_R).quantise(over)[0], shift)

    def output_layers(self, halvings: int, wide: bool = False) -> OutputLayers:
        return OutputLayers(self.taught, halvings, wide)

    def output_filters(self) -> OutputLayers:
        """Recursive least squares on output layers, whose equations are quartered."""
        wide = self.squares(SQUARE) + int(OUTPUT_LAYER * 2**SQUARE)
        return OutputLayers(self.taught, filters=Recursive(self.taught, wide >> 4, 18, root=True))


@dataclass(frozen=True)
class Rule:
    """A rule, how often it sees the placements, and what it takes.

    passes: 1 if a placement is shown and forgotten.
    words: Words of what is learned.
    parts: See ``golden.learning.costs``.
    working: Words that are kept for each placement besides its readings and outputs.
    """

    name: str
    passes: int
    make: Callable[[Setting], Learner | OutputLayers]
    words: int
    parts: Sequence[str] = ()
    working: int = 0

    @property
    def kept(self) -> bool:
        """Whether placements are kept."""
        return self.passes > 1

    def memory(self, placements: int) -> int:
        """Words of what is learned and kept."""
        return self.words + placements * (8 * self.kept + self.working)


NONE, COMPUTER = "no correction", "make recalibrate"
QUOTIENT = ("quotient",)
ROOT = ("quotient", "square root", "call")
KACZMARZ, LMS = "Kaczmarz", "LMS, constant step"
RECURSIVE = "recursive least squares, square root, 18 bits"
RULES = (
    Rule(KACZMARZ, 1, lambda s: s.gradient(1), 8, QUOTIENT),
    Rule(KACZMARZ, 100, lambda s: s.gradient(3), 8, QUOTIENT),
    Rule(
        "Kaczmarz, theta in 32 bits",
        100,
        lambda s: s.gradient(3, wide=True),
        16,
        (*QUOTIENT, "two words"),
    ),
    Rule(
        "Kaczmarz, derivatives by differences",
        100,
        lambda s: s.gradient(3, equation=by_differences),
        8,
        QUOTIENT,
    ),
    Rule(
        "Kaczmarz by differences, own outputs between networks",
        100,
        lambda s: s.gradient(3, equation=partial(by_differences, alone=False)),
        8,
        QUOTIENT,
    ),
    Rule(LMS, 400, Setting.constant, 8),
    Rule(
        "recursive least squares, covariance, 18 bits",
        1,
        lambda s: s.recursive(18, False),
        72,
        ROOT,
    ),
    Rule(
        "recursive least squares, covariance, 36 bits",
        1,
        lambda s: s.recursive(36, False),
        136,
        (*ROOT, "two words"),
    ),
    Rule(RECURSIVE, 1, lambda s: s.recursive(18, True), 72, ROOT),
    Rule(
        "recursive least squares, square root, 36 bits",
        1,
        lambda s: s.recursive(36, True),
        136,
        (*ROOT, "two words"),
    ),
    Rule(RECURSIVE, 3, lambda s: s.recursive(18, True), 80, ROOT),
    Rule("conjugate gradients, 18 bits", 3, lambda s: s.conjugate(18), 32, (*QUOTIENT, "call"), 40),
    Rule(
        "conjugate gradients, 36 bits",
        3,
        lambda s: s.conjugate(36),
        56,
        (*QUOTIENT, "call", "two words"),
        48,
    ),
    Rule("perturbation (SPSA)", 2000, lambda s: s.perturbation(1), 8, ("random signs",)),
    Rule("output layers, normalised LMS", 1, lambda s: s.output_layers(1), 27, QUOTIENT),
    Rule("output layers, Kaczmarz", 20, lambda s: s.output_layers(0), 27, QUOTIENT),
    Rule(
        "output layers, normalised LMS, 32 bits",
        100,
        lambda s: s.output_layers(3, wide=True),
        54,
        (*QUOTIENT, "two words"),
    ),
    Rule("output layers, recursive least squares", 1, Setting.output_filters, 218, ROOT),
)


@dataclass(frozen=True)
class Draws:
    """The drifts of a seed, and the placements that are shown under each noise.

    vectors: The recording, with the loads that are known.
    readings, shape (drifts, rows, sensors): The whole recording as drifted sensors read it without
        noise.
    shown, shape (drifts, placements): Rows of the placements, in their order.
    noisy, shape (drifts, placements, sensors): What is read when they are shown.
    """

    scene: Scene
    vectors: Vectors
    setting: Setting
    readings: Real
    shown: NDArray[np.intp]
    noisy: Real

    def lesson(self, count: int) -> Lesson:
        """The first placements, for every drift and noise."""
        targets = SIGNAL.quantise(self.vectors.targets)[0]
        whole = Lesson(SIGNAL.quantise(self.noisy)[0], targets[self.shown])
        return whole.first(count)

    def worst(self, outputs: Codes, drift: int, count: int) -> Real:
        """The worst error of each output over the rows that were not shown, in percent."""
        errors = self.vectors.percent_errors(SIGNAL.to_real(outputs))
        return np.asarray(np.delete(errors, self.shown[drift, :count], axis=0).max(axis=0))


def draws(seed: int, noises: Sequence[float] = NOISES, count: int = DRAWS) -> Draws:
    """The drifts of a seed: for each noise the same ones."""
    scene = load_scene(SCENE)
    vectors = scene.vectors()
    most = max(COUNTS)
    readings, shown, noisy = [], [], []
    for noise in noises:
        recorded = Sensitivity.of(scene, np.full(len(scene.sensors), noise))
        rows = np.array([one.row for one in islice(proposed(recorded), most)])
        for number in range(count):
            rng = np.random.default_rng([seed, number])
            readings.append(DRIFT.of(vectors.inputs, rng))
            shown.append(rows)
            read = readings[-1][rows]
            noisy.append(read + noise * rng.standard_normal(read.shape))
    setting = shipped(scene, np.repeat(noises, count))
    return Draws(scene, vectors, setting, np.array(readings), np.array(shown), np.array(noisy))


def shipped(scene: Scene, noises: Real) -> Setting:
    """What rules are given with the networks of a scene, for the noise of each drift."""
    recorded = Sensitivity.of(scene, np.zeros(len(scene.sensors)))
    taught = Corrected.of(scene.mlps(), recorded.gain, recorded.offset)
    vectors = scene.vectors()
    steps = constants(taught, vectors.codes, SIGNAL.quantise(vectors.targets)[0])
    return Setting(taught, Noise.of(taught, vectors), noises, steps)


@dataclass(frozen=True)
class Found:
    """What a rule reached.

    worst: shape (drifts, outputs).
    """

    worst: Real
    unit: Unit


def learned(rule: Rule, drawn: Draws, count: int) -> Found:
    """What a rule reaches with so many placements, for all drifts."""
    lesson, learner = drawn.lesson(count), rule.make(drawn.setting)
    unit = Unit(lesson.drifts)
    codes = SIGNAL.quantise(drawn.readings)[0]
    if isinstance(learner, OutputLayers):
        outputs = learner.process(learner.learn(lesson, rule.passes, unit), codes)
    else:
        theta = learner.learn(lesson, rule.passes, unit)
        outputs = np.array(
            [
                drawn.setting.taught.process(np.broadcast_to(one, (len(rows), len(one))), rows)
                for one, rows in zip(theta, codes, strict=True)
            ]
        )
    return Found(
        np.array([drawn.worst(one, drift, count) for drift, one in enumerate(outputs)]), unit
    )


def _found(number: int, count: int, drawn: Draws) -> Found:
    return learned(RULES[number], drawn, count)


def recalibrated(drawn: Draws, count: int) -> Real:
    """What make recalibrate reaches on a computer, bit-true, shape (drifts, outputs)."""
    scene, vectors = drawn.scene, drawn.vectors
    found = []
    for drift, noise in enumerate(drawn.setting.readings):
        recorded = Sensitivity.of(scene, np.full(len(scene.sensors), noise))
        rows = drawn.shown[drift, :count]
        placements = Placements(
            drawn.noisy[drift, :count],
            vectors.targets[rows],
            vectors.scale[rows],
            np.ones(count),
        )
        theta = fit(recorded, placements).theta
        mlps = corrected(scene, recorded.correction(theta))
        codes = SIGNAL.quantise(drawn.readings[drift])[0]
        found.append(drawn.worst(evaluate(integer_networks("cascade", mlps), codes), drift, count))
    return np.array(found)


def uncorrected(drawn: Draws, count: int) -> Real:
    """The errors without a correction, shape (drifts, outputs)."""
    networks = drawn.setting.taught.networks
    codes = SIGNAL.quantise(drawn.readings)[0]
    return np.array(
        [drawn.worst(evaluate(networks, one), drift, count) for drift, one in enumerate(codes)]
    )


def on_line_learning(seed: int) -> Table:
    """The errors that are left after each rule, and what the rule takes."""
    drawn = draws(seed)
    cells = [(number, count) for count in COUNTS for number in range(len(RULES))]
    all_found = iter(Parallel(n_jobs=-1)(delayed(_found)(*cell, drawn) for cell in cells))
    rows: list[list[Cell]] = []
    for count in COUNTS:
        computer = recalibrated(drawn, count)
        for name, worst in ((NONE, uncorrected(drawn, count)), (COMPUTER, computer)):
            rows += _rows(name, None, count, worst, computer)
        for rule in RULES:
            found = next(all_found)
            rows += _rows(rule.name, rule, count, found.worst, computer, found.unit)
    return Table(
        "on_line_learning",
        [
            "rule",
            "passes",
            "noise mV",
            "placements",
            *(f"{name} %" for name in drawn.scene.outputs),
            *(f"{name} {end} %" for name in drawn.scene.outputs for end in ("from", "to")),
            "times",
            "steps",
            "clocks",
            "words",
            "LUTs",
            "sum bits",
            "does not fit",
        ],
        rows,
        NOTES["on_line_learning"],
    )


def _rows(
    name: str, rule: Rule | None, count: int, worst: Real, computer: Real, unit: Unit | None = None
) -> list[list[Cell]]:
    """The rows of a rule for a number of placements, one for each noise."""
    found: list[list[Cell]] = []
    for number, noise in enumerate(NOISES):
        at = slice(number * DRAWS, (number + 1) * DRAWS)
        medians = np.median(worst[at], axis=0)
        ends = np.stack([worst[at].min(axis=0), worst[at].max(axis=0)], axis=1).ravel()
        times = float((medians / np.median(computer[at], axis=0)).max())
        costs: list[Cell] = [None] * 6
        if rule and unit:
            costs = [
                round(unit.steps / (rule.passes * count)),
                unit.clocks,
                rule.memory(count),
                luts(rule.parts),
                unit.bits,
                lost(unit, at),
            ]
        cells: list[Cell] = [name, rule.passes if rule else None, 1e3 * noise, count]
        found.append([*cells, *map(float, medians), *map(float, ends), times, *costs])
    return found


def lost(unit: Unit, drifts: slice) -> str:
    """The names of words that did not always fit, with their part; '-' where all did."""
    parts: Mapping[str, float] = {
        name: 100 * float(lost[drifts].mean()) / unit.words[name]
        for name, lost in unit.saturated.items()
        if name not in AS_EVER
    }
    return ", ".join(f"{name} {part:.2g} %" for name, part in parts.items() if part) or "-"
