"""The errors on the swing for different past samples, noise and sampling rates.

Each network is compared with linear estimators, which need no hidden nodes: least squares on the
same samples, and the Wiener filter on every sample of the same past.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np

from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from golden.sensing.frame_window import FrameWindow
from golden.trained.mlp import tanh
from golden.trained.window import Window
from tactus.physics.swing_data import ANGLES, GAINS, NOISE, RATE, Coding, record
from tactus.report.measure.table import Cell, Table
from tactus.scene.metrics import displacement_errors
from tactus.train.descent.levenberg_marquardt import descend
from tactus.train.descent.objective import Objective, Rows, pack, unpack
from tactus.train.descent.search import starting_weights

Estimate = Callable[[Real], Real]

OUTPUTS = ("x", "y", "z")
# How many frames back the samples lie, at 200 a second. The last are those of scene swing-window.
DELAYS = (
    (0,),
    (0, 4),
    (0, 4, 8, 16),
    (0, 4, 8, 16, 32, 64),
    (0, 4, 8, 16, 32, 48, 64, 96, 128),
)
NOISES = (0.0, NOISE, 2 * NOISE)
RATES = (RATE / 2, RATE, 2 * RATE)
HIDDEN, STEPS, PATIENCE, WEIGHT_DECAY = 7, 80, 40, 1e-6
# The rows of the training run that train. As many rows between them validate.
ROWS = 250
SENSORS = 3
# The noise of a converter that gives the nearest code, and of the mean that is subtracted.
ROUNDED = 2.0**-SIGNAL.frac / np.sqrt(6)

NOTES = {
    "past": "The figures are errors by equation 6.6, in floating point. They are measured on "
    f"releases from {ANGLES[1]:g} and {ANGLES[2]:g} degrees, of which the worse one is shown; a "
    f"release from {ANGLES[0]:g} degrees trains. One network with {HIDDEN} hidden nodes has all "
    f"outputs. It is trained on {ROWS} rows, and as many rows between them decide when training "
    "stops. 'Least squares' is the linear function of the same samples that fits the training run "
    "best. 'Wiener' is the linear function of every sample since the oldest of them that has the "
    "least error under the noise, which it knows. 'Words' is the size of the memory that stores "
    "the samples.",
}


@dataclass(frozen=True)
class Case:
    """One case of the table: what is varied, and its values.

    delays: How many frames back the samples lie.
    noise: The noise at each sensor in V.
    rate: The number of frames per second.
    """

    varied: str
    delays: tuple[int, ...]
    noise: float = NOISE
    rate: float = RATE

    @property
    def window(self) -> Window:
        return Window((self.delays,) * SENSORS)


def cases() -> Iterator[Case]:
    """All cases of the table."""
    for delays in DELAYS:
        yield Case("samples", delays)
    longest = DELAYS[-1]
    for noise in NOISES:
        yield Case("noise", longest, noise)
    for rate in RATES:
        yield Case("rate, same frames", longest, rate=rate)
    for rate in RATES:
        same = tuple(round(delay * rate / RATE) for delay in longest)
        yield Case("rate, same times", same, rate=rate)


def past(seed: int) -> Table:
    """The errors of the worse of two independent runs."""
    found = cache(lambda delays, noise, rate: _errors(Case("", delays, noise, rate), seed))
    rows: list[list[Cell]] = []
    for case in cases():
        errors = found(case.delays, case.noise, case.rate)
        words = _words(case.window)
        for c, output in enumerate(OUTPUTS):
            rows.append(
                [
                    case.varied,
                    len(case.delays),
                    case.window.past / case.rate,
                    1e6 * case.noise,
                    case.rate,
                    words,
                    output,
                    *(float(error[c]) for error in errors),
                ]
            )
    return Table(
        "past",
        [
            "varied",
            "samples a sensor",
            "past s",
            "noise uV",
            "rate Hz",
            "words",
            "output",
            "network %",
            "least squares %",
            "Wiener %",
        ],
        rows,
        NOTES["past"],
    )


def _words(window: Window) -> int:
    """The words of the memory that keeps the past, or 0 without a past."""
    return FrameWindow(SIGNAL, window, 0, len(window.taps)).words if window.past else 0


@dataclass(frozen=True)
class Release:
    """One run: the readings of the sensors, and the coded targets."""

    sensors: Real
    targets: Real

    def rows(self, window: Window) -> tuple[Real, Real]:
        """The inputs of an estimator, and the outputs that it should give."""
        return window.frames(self.sensors), self.targets[window.past :]


def _errors(case: Case, seed: int) -> tuple[list[float], list[float], list[float]]:
    """The errors of the network, of least squares and of the Wiener filter, for each output."""
    runs = [
        record(angle, seed + n, case.noise, rate=case.rate) for n, angle in enumerate(ANGLES[:3])
    ]
    coding = Coding.of(runs[0])
    learnt, *held = (Release(*np.split(coding.code(run), [SENSORS], axis=1)) for run in runs)
    still = record(ANGLES[0], seed, 0.0, rate=case.rate).sensors
    window = case.window
    every = Window((tuple(range(window.past + 1)),) * SENSORS)
    network = _network(*learnt.rows(window), np.random.default_rng(seed))
    fitted = _fitted(*learnt.rows(window))
    wiener = _wiener(every.frames(still), learnt.targets[window.past :], every, case.noise)
    worst = []
    for estimate, seen in ((network, window), (fitted, window), (wiener, every)):
        errors = []
        for run in held:
            inputs, targets = run.rows(seen)
            errors.append([e.percent for e in displacement_errors(estimate(inputs), targets)])
        worst.append(np.max(errors, axis=0).tolist())
    return worst[0], worst[1], worst[2]


def _network(inputs: Real, targets: Real, rng: np.random.Generator) -> Estimate:
    """The estimator that is a trained network."""
    step = len(inputs) // ROWS
    training, validation = (
        Rows(inputs[first::step], targets[first::step], np.ones_like(targets[first::step]))
        for first in (0, step // 2)
    )
    shape = (inputs.shape[1], HIDDEN, targets.shape[1])
    objective = Objective(shape, tanh, training, validation, WEIGHT_DECAY, PATIENCE)
    mlp = unpack(objective.search(descend, pack(starting_weights(shape, rng)), STEPS), shape)
    return lambda given: mlp.process(given, tanh)


def _fitted(inputs: Real, targets: Real) -> Estimate:
    """The linear estimator with the least squared error."""
    weights = np.linalg.lstsq(_with_one(inputs), targets)[0]
    return lambda given: _with_one(given) @ weights


def _wiener(still: Real, targets: Real, window: Window, noise: float) -> Estimate:
    """The linear estimator with the least mean square error under noise: R w = p (Wiener, Hopf).

    ``still`` holds its inputs for a recording without noise.
    """
    taken = _with_one(still)
    own = [(noise * GAINS[tap.sensor]) ** 2 + ROUNDED**2 for tap in window.taps]
    correlation = taken.T @ taken / len(taken) + np.diag([*own, 0.0])
    weights = np.linalg.solve(correlation, taken.T @ targets / len(taken))
    return lambda given: _with_one(given) @ weights


def _with_one(inputs: Real) -> Real:
    return np.column_stack([inputs, np.ones(len(inputs))])
