"""The remaining error of a drifted digit after few or many known placements."""

from itertools import islice

import numpy as np
from numpy.typing import NDArray

from golden.numbers.real import Real
from tactus.recalibration.fit import Fit, fit, left_out
from tactus.recalibration.outlook import helps, proposed
from tactus.recalibration.sensitivity import Placements, Sensitivity
from tactus.report.measure.table import Cell, Row, Table
from tactus.scene import Scene, load_scene
from tactus.scene.disturbance import Disturbance
from tactus.scene.scale import readings

SCENE = "digit"
DRIFT = Disturbance(gain=0.03, offset=0.02)
NOISES = (0.0, 0.002)  # V
COUNTS = (3, 4, 6, 8, 10, 20, 40)
DRAWS = 10

# With little drift and much noise, a correction could do harm.
FEW = 8
SMALL = (0.0, 0.05)
MUCH_NOISE = (0.01, 0.03)  # V
TIMES = (1, 16)
NOISY_DRAWS = 5


def errors(scene: Scene, signals: Real) -> Real:
    """The mean error of each output over the recording, in percent and floating point."""
    found: Real = scene.vectors().percent_errors(scene.process_real(signals)).mean(axis=0)
    return found


def read(
    recorded: Sensitivity,
    drifted: Real,
    rows: NDArray[np.intp],
    times: int,
    rng: np.random.Generator,
) -> Placements:
    """Rows of the recording as placements, each read ``times`` times with noise."""
    there = recorded.recorded.at(rows)
    noise = recorded.noise * rng.standard_normal((times, *there.inputs.shape)).mean(axis=0)
    return Placements(drifted[rows] + noise, there.targets, there.scale, there.times * times)


def error_left(recorded: Sensitivity, drifted: Real, found: Fit) -> Real:
    """The errors that remain when drifted readings are corrected."""
    return errors(recorded.scene, readings(drifted, recorded.correction(found.theta)))


def _of(scene: Scene, noise: float) -> Sensitivity:
    return Sensitivity.of(scene, np.full(len(scene.sensors), noise))


def recalibration(seed: int) -> Table:
    """The errors before and after, for the number and choice of placements, and for noise."""
    scene, rng = load_scene(SCENE), np.random.default_rng(seed)
    vectors = scene.vectors()
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
        recorded = _of(scene, noise)
        telling = np.array([one.row for one in islice(proposed(recorded), max(COUNTS))])

        def after(one: Real, at: NDArray[np.intp], known: Sensitivity = recorded) -> Real:
            return error_left(known, one, fit(known, read(known, one, at, 1, rng)))

        for count in COUNTS:
            at_random = [after(one, rng.permutation(len(one))[:count]) for one in drifted]
            chosen = [after(one, telling[:count]) for one in drifted]
            rows.append(row(count, "at random", noise, at_random))
            rows.append(row(count, "telling most", noise, chosen))
    return Table(
        "recalibration",
        ["placements", "chosen", "noise mV", *(f"{name} %" for name in scene.outputs), "mean %"],
        rows,
        f"The figures are mean errors of {SCENE} over all recorded rows in floating point. They "
        f"are means over {DRAWS} drifts of {100 * DRIFT.gain:g} % of the gains and "
        f"{1e3 * DRIFT.offset:g} mV of the offsets: before a correction, and after a fit of gain "
        "and offset to rows of the recording, each read once with noise. 'Telling most' are the "
        "rows that make recalibrate proposes, in that order.",
    )


def recalibration_noise(seed: int) -> Table:
    """Whether corrections help if the drift of the sensors is small compared with their noise."""
    scene, rng = load_scene(SCENE), np.random.default_rng(seed)
    vectors = scene.vectors()
    rows: list[Row] = []
    for noise in MUCH_NOISE:
        recorded = _of(scene, noise)
        for drift in SMALL:
            gains = 1 + drift * np.array([1, 0, 1, 0])
            drifted = vectors.inputs * gains
            before = float(errors(scene, drifted).mean())
            for times in TIMES:
                at = np.array([one.row for one in islice(proposed(recorded, times), FEW)])
                after, kept, written = [], [], 0
                for _ in range(NOISY_DRAWS):
                    placements = read(recorded, drifted, at, times, rng)
                    found = fit(recorded, placements)
                    after.append(float(error_left(recorded, drifted, found).mean()))
                    alone = left_out(recorded, placements, found)
                    sure = helps(recorded, placements, found, alone)
                    written += sure
                    kept.append(after[-1] if sure else before)
                rows.append(
                    {
                        "noise mV": 1e3 * noise,
                        "drift %": 100 * drift,
                        "times": times,
                        "before %": before,
                        "written": written,
                        "of these worse": sum(one > before for one in kept),
                        "after %": float(np.mean(kept)),
                        "all written %": float(np.mean(after)),
                        "worse": sum(one > before for one in after),
                    }
                )
    return Table.of(
        "recalibration_noise",
        rows,
        f"The figures are mean errors of the outputs of {SCENE} over all recorded rows in floating "
        "point, when the gains of sensors 1 and 3 have drifted: before a correction, and after "
        f"make recalibrate with the {FEW} placements that it proposes, each read so many times. "
        f"They are means over {NOISY_DRAWS} draws of noise. The command writes a correction if it "
        "is sure to help, and otherwise leaves the scene as it is. The last two columns show what "
        "would happen if it wrote every correction.",
    )
