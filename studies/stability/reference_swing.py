"""A reference for damped swings that is no contestant: Gauss and Legendre's implicit method.

The contestants are those of SciPy, among them Radau IIA and backward differences; this collocation
method belongs to neither family. It has three stages and order 6, is stable for any damping, and is
computed in extended precision. Steps are graded: short ones first, in which the fast part of the
motion dies away. Two runs, the second with half the steps, are extrapolated (Richardson), and their
difference tells how far the reference can be trusted.
"""

import itertools
import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ellipj, ellipkm1

from golden.numbers.real import Real, checked
from studies.physics.swing import Swing

WIDE = np.longdouble
Wide = NDArray[np.floating[Any]]
_ROOT = np.sqrt(WIDE(15))
_STAGES = np.array(
    [
        [WIDE(5) / 36, WIDE(2) / 9 - _ROOT / 15, WIDE(5) / 36 - _ROOT / 30],
        [WIDE(5) / 36 + _ROOT / 24, WIDE(2) / 9, WIDE(5) / 36 - _ROOT / 24],
        [WIDE(5) / 36 + _ROOT / 30, WIDE(2) / 9 + _ROOT / 15, WIDE(5) / 36],
    ]
)
_WEIGHTS = np.array([WIDE(5) / 18, WIDE(4) / 9, WIDE(5) / 18])
_ORDER = 6
# The first step is this part of the shortest time of the motion, and each one longer than the last.
FIRST, GROWTH = 1 / 32, 1.15
# Parts of the longest time of the motion that a step may take.
LONGEST = 1 / 32
# A Newton step this small, relative to the state, is the last.
SETTLED, MOST_NEWTON = 1e-17, 50


def reference_swing(swing: Swing, start: float, times: Real) -> tuple[Real, Real, float]:
    """Angle and speed at the times, which begin at 0, and the error of the angle at most.

    The error is the difference between both runs, of which the better one is extrapolated.
    """
    runs = [_run(swing, start, times, halves) for halves in (1, 2)]
    part = WIDE(2**_ORDER)
    angle, speed = ((part * runs[1][k] - runs[0][k]) / (part - 1) for k in (0, 1))
    error = float(np.abs(runs[1][0] - runs[0][0]).max())
    return angle.astype(np.float64), speed.astype(np.float64), error


def _run(swing: Swing, start: float, times: Real, halves: int) -> Wide:
    """Angle and speed, shape (2, times), with each step divided into ``halves``."""
    rates = np.array([swing.damping_rate, swing.natural_frequency], dtype=WIDE) ** [1, 2]
    state = np.array([WIDE(start), WIDE(0)])
    found = [state]
    fast, slow = swing.damping_rate, swing.natural_frequency
    if fast > slow:
        slow *= slow / fast
    step, longest = FIRST / max(fast, slow), LONGEST / slow
    for before, after in itertools.pairwise(times):
        at = before
        while at < after:
            # A step that would leave a sliver reaches to the end.
            span = after - at if at + 1.5 * step >= after else step
            for _ in range(halves):
                state = _stepped(state, span / halves, rates)
            at = after if span == after - at else at + span
            step = min(step * GROWTH, longest)
        found.append(state)
    return np.array(found).T


def _stepped(state: Wide, span: float, rates: Wide) -> Wide:
    """One step. The stages' speeds are solved for; their angles follow from them."""
    phi, speed = state
    damping, stiffness = rates
    reach = span * _STAGES
    speeds = np.full(3, speed)
    for _ in range(MOST_NEWTON):
        angles = phi + reach @ speeds
        left = speeds - speed + reach @ (damping * speeds + stiffness * np.sin(angles))
        slope = np.eye(3) + reach * damping + (reach * (stiffness * np.cos(angles))) @ reach
        # Newton's matrix need not be exact, so that floating point solves it.
        move = np.linalg.solve(slope.astype(np.float64), left.astype(np.float64))
        speeds = speeds - move
        if np.abs(move).max() <= SETTLED * (np.abs(speeds).max() + SETTLED):
            break
    angles = phi + reach @ speeds
    force = -damping * speeds - stiffness * np.sin(angles)
    return np.array([phi + span * (_WEIGHTS @ speeds), speed + span * (_WEIGHTS @ force)])


def undamped_angle(swing: Swing, start: float, time: ArrayLike) -> Real:
    """phi in closed form, without damping and released at rest, as a check of ``swing_motion``.

    It uses Jacobi's elliptic functions: 2 asin(k sn(K - omega t, k)) with k = sin(start / 2). The
    damping of ``swing`` is ignored.

    start: In rad; the magnitude must be at least 1e-6 below pi, because the period of an upright
        start is infinite.
    time: In s, 0 to 1e9.
    """
    most = math.pi - 1e-6
    _, t = checked(start=(start, -most, most), time=(time, 0, 1e9))
    k, rest = math.sin(start / 2), math.cos(start / 2) ** 2
    sn = ellipj(ellipkm1(rest) - swing.natural_frequency * t, 1 - rest)[0]
    return np.asarray(2 * np.arcsin(k * sn))
