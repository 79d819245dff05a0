"""Ill-conditioned problems: fits, corrections and a board that learns, with more digits beside."""

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np

from golden.learning.corrected import THETA
from golden.learning.gradient import ERROR, ROW, STEP, lms_step
from golden.numbers.real import Real
from golden.trained.dense import packed, tanh
from studies.stability import digits
from studies.stability.case import Row, largest
from studies.stability.digits import DIGITS
from tactus.recalibration.fit import Fit, fit
from tactus.recalibration.outlook import outlook
from tactus.recalibration.sensitivity import Placements, Sensitivity, outputs_and_slopes
from tactus.scene import Scene, load_scene
from tactus.scene.disturbance import Disturbance
from tactus.train.objective import Objective, Rows, levenberg_marquardt

FITS = "Levenberg-Marquardt"
AGREE = f"agree with {DIGITS} digits"
LEARNED = 400
EPS = float(np.finfo(np.float64).eps)


def networks() -> Iterator[Row]:
    """Steps of Levenberg and Marquardt at lambda 0, on the networks of the digit."""
    scene = load_scene("digit")
    steps = list(_linearised(scene))
    conditions = [float(np.linalg.cond(slopes)) for slopes, _ in steps]
    case = f"lambda 0, Jacobians of digit, condition {min(conditions):.0e} to {max(conditions):.0e}"
    parts, excess = [], []
    for (slopes, errors), condition in zip(steps, conditions, strict=True):
        found = _descended(slopes, errors)
        step, length = digits.least_squares(slopes, -errors)
        miss = float(np.linalg.norm(found - step) / np.linalg.norm(step))
        parts.append(miss / (condition * EPS))
        excess.append(float(np.linalg.norm(slopes @ found + errors)) / length - 1)
    # Of normal equations, J' J, the error would be a multiple of the condition's square.
    yield Row(FITS, case, AGREE, "error of the step / (condition x 2^-52)", max(parts), 10)
    yield Row(FITS, case, AGREE, "sum of squares above the least", max(0.0, *excess), 1e-10)
    # Two nodes alike: the columns of one are those of the other, and no step is the only one.
    slopes, errors = steps[0]
    twice = np.hstack([slopes, slopes])
    found = _descended(twice, errors)
    _, length = digits.least_squares(slopes, -errors)
    above = float(np.linalg.norm(twice @ found + errors)) / length - 1
    case = "lambda 0, every node twice: a singular Jacobian"
    yield Row(FITS, case, AGREE, "sum of squares above the least", abs(above), 1e-10)


def _linearised(scene: Scene) -> Iterator[tuple[Real, Real]]:
    """Jacobian and errors of each network, without the weight decay that would condition them."""
    vectors = scene.vectors()
    outputs: list[Real] = []
    for number, mlp in enumerate(scene.mlps()):
        inputs = np.hstack([vectors.inputs, *outputs])
        rows = Rows(inputs, vectors.targets[:, [number]], vectors.scale[:, [number]])
        aim = Objective(mlp, rows, rows, len(inputs), tanh, 0.0)
        point, count = packed(mlp), len(inputs)
        yield aim.jacobian(point)[:count], aim.residuals(point)[:count]
        outputs.append(mlp.process(inputs))


def _descended(slopes: Real, errors: Real) -> Real:
    """Where a descent ends, of a sum of squares of straight functions."""
    aim: Any = SimpleNamespace(
        residuals=lambda point: errors + slopes @ point, jacobian=lambda _: slopes
    )
    return levenberg_marquardt(aim, np.zeros(slopes.shape[1]), 400)


def recalibration() -> Iterator[Row]:
    """A correction from one placement, and from one that is made again and again."""
    scene = load_scene("digit")
    vectors = scene.vectors()
    for name, drift in (("expected drift", None), ("drift of 100", Disturbance(0, 100.0, 100.0))):
        recorded = Sensitivity.of(scene, np.zeros(4), drift)
        for rows, which in (([5], "one placement"), ([5] * 24, "24 equal ones")):
            there = Placements(
                vectors.inputs[rows], vectors.targets[rows], vectors.scale[rows], np.ones(len(rows))
            )
            found = fit(recorded, there)
            slopes = _equations(recorded, there, found)
            condition = float(np.linalg.cond(slopes))
            exact = digits.inverse_of_squares(slopes)
            miss = largest(np.diag(found.root @ found.root.T) / np.diag(exact) - 1)
            case = f"{which}, {name}, condition {condition:.0e}"
            figure, bound = "relative error of variances", 10 * condition * EPS
            yield Row("recalibration", case, AGREE, figure, miss, bound)
            if len(rows) > 1:
                sure = outlook(recorded, found)
                figures = [*sure.before, *sure.after, *sure.chances[0]]
                off = int(not np.isfinite(figures).all())
                yield Row("recalibration", case, "give an outlook", "not finite", off, 0)


def _equations(recorded: Sensitivity, there: Placements, found: Fit) -> Real:
    """The derivatives of all equations at the correction, with those that draw it towards 0."""
    _, slopes = outputs_and_slopes(recorded.scene, recorded.moved(there.inputs, found.theta))
    by_theta = recorded.by_theta(slopes, there.inputs) * (100 / there.scale)[:, :, np.newaxis]
    white = np.linalg.solve(np.linalg.cholesky(recorded.spread(there)), by_theta)
    return np.concatenate([white.reshape(-1, white.shape[2]), np.eye(white.shape[2])])


def learning() -> Iterator[Row]:
    """Least mean squares of a board that learns, whose equations are nearly alike."""
    rng = np.random.default_rng(0)
    base, *others = rng.uniform(-0.08, 0.08, (3, 8))
    rows = ROW.quantise(np.array([base, *(base + 0.01 * other for other in others)]))[0]
    sought = THETA.quantise(rng.uniform(-2, 2, 8))[0]
    real, aim = ROW.to_real(rows), THETA.to_real(sought)
    constant = STEP.quantise(0.5 / np.array([(real**2).sum(axis=1).max()]))[0]
    rate = float(STEP.to_real(constant)[0])
    theta = np.zeros((1, 8), dtype=np.int64)
    away, grown = [float(np.linalg.norm(aim))], 0.0
    for number in range(LEARNED * len(rows)):
        row = rows[[number % len(rows)]]
        error = ERROR.quantise(ROW.to_real(row) @ (aim - THETA.to_real(theta[0])))[0]
        # Without a leak, which would lead away from what is sought.
        theta, _ = lms_step(theta, error, row, constant[0], 0)
        away.append(float(np.linalg.norm(THETA.to_real(theta[0]) - aim)))
        grown = max(grown, away[-1] - away[-2])
    values = np.linalg.svd(real, compute_uv=False)
    case = f"{LEARNED} passes, three equations, condition {values[0] / values[-1]:.0e}"
    code = 2.0**-THETA.frac
    # A step moves towards what is sought, and rounds each of eight words by half a code, besides
    # the error and the row by less.
    must = "move away by no more than rounding"
    most = 0.5 * np.sqrt(8) + 1
    yield Row("board that learns", case, must, "codes", grown / code, most)
    exact = digits.least_mean_squares(real, real @ aim, rate, LEARNED)
    apart = float(np.linalg.norm(THETA.to_real(theta[0]) - exact))
    figure = "distance in codes"
    yield Row("board that learns", case, AGREE, figure, apart / code, most * len(away))
