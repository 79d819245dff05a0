"""Stiff and extreme cases of the physics: swing, plate, conditioning."""

import itertools
import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.integrate import solve_ivp
from scipy.special import ellipj, ellipkm1

from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from studies.physics.plate import TERMS, Plate
from studies.physics.swing import Swing, bearing_forces, foot_forces, swing_motion
from studies.physics.swing_data import REST, Conditioning, read_sensor
from studies.stability.case import Row, accepted, largest, worst
from studies.stability.digits import DIGITS, deflection

# The damping rates of stiff swings in 1/s.
RATES = (1e2, 1e4, 1e6)
SAMPLES = 500
# The error that an angle may have at the default tolerance, in rad.
INTEGRATED = 1e-8
# The relative tolerance of the reference of damped swings.
REFERENCE = 1e-13
# How many N a foot's force changes for a rad, at most: D a_g (1 + 1 / tan(psi)) / 2 is 156 N of a
# swing that creeps, and the rest is for its speed.
STEEPEST = 200.0
# What Plate.influence promises of its rounding, in parts of the largest deflection; and for b =
# a / 100, where cancellation costs four more digits.
ROUNDING, CANCELLED = 1e-13, 1e-9
PERIODS = 1000
# Directions from a load, in parts of length and width.
BESIDE = ((0, 0), (1, 0), (0, 1), (1, 1))
ENERGY_DRIFT = 1e-8
LIMIT_TERMS = 100_000
AGREE = f"agree with {DIGITS} digits"


def swings() -> Iterator[Row]:
    start = math.radians(30)
    for rate in RATES:
        heavy = Swing(damping=rate * Swing().arm)
        # Three times the time in which the angle falls to 1 / e, so that it does move.
        slow = heavy.natural_frequency**2 / rate
        motion = swing_motion(heavy, start, 3 / slow, slow * SAMPLES / 3)
        angle, speed = reference_swing(heavy, start, motion.time)
        case = f"damped at {rate:g} 1/s, stiff {stiffness_of(heavy):.1e}"
        must = "follow a reference of another family"
        miss = largest(motion.angle - angle)
        yield Row("swing", case, must, "error rad", miss, INTEGRATED)
        exact, found = (
            foot_forces(heavy, *one) for one in ((angle, speed), (motion.angle, motion.speed))
        )
        miss = largest(np.subtract(found, exact))
        yield Row("swing", case, must, "error of a foot's force N", miss, STEEPEST * INTEGRATED)
        # Once the fast part has died away, phi' = -slow sin(phi). The start at rest and the next
        # term of the series shift the angle by slow / rate each, at most.
        creep = math.log(math.tan(start / 2)) - slow * motion.time
        away = largest(motion.angle - 2 * np.arctan(np.exp(creep)))
        must = "follow the slow manifold"
        yield Row("swing", case, must, "distance rad", away, 2 * slow / rate + INTEGRATED)
    # Measured in units of its natural frequency, every undamped pendulum moves alike.
    jacobi = "follow Jacobi's closed form"
    for arm in (1e-3, 100.0):
        other = Swing(arm=arm, damping=0)
        seconds = 10 / other.natural_frequency
        motion = swing_motion(other, start, seconds, 200 / seconds)
        miss = largest(motion.angle - undamped_angle(other, start, motion.time))
        yield Row("swing", f"arm of {arm:g} m", jacobi, "error rad", miss, INTEGRATED)
    free = Swing(damping=0)
    steep = math.radians(179.9)
    motion = swing_motion(free, steep, 4)
    miss = largest(motion.angle - undamped_angle(free, steep, motion.time))
    yield Row("swing", "from 179.9 degrees", jacobi, "error rad", miss, 1e-6)
    forces = largest(*bearing_forces(free, motion.angle, motion.speed))
    # The energy gives a bound of the pull: D a_g (3 - 2 cos(start)) at the bottom.
    most = float(free.mass * 9.80665 * (3 - 2 * math.cos(steep))) * (1 + 1e-4)
    must = "pull no more than its energy allows"
    yield Row("swing", "from 179.9 degrees", must, "bearing force N", forces, most)
    motion = swing_motion(free, math.pi, 3)
    away = largest(motion.angle - math.pi)
    yield Row("swing", "upright", "stay upright", "angle from upright rad", away, 1e-8)
    motion = swing_motion(free, 0.0, 3)
    yield Row("swing", "hanging", "stay at rest", "angle rad", largest(motion.angle), 0)
    seconds = PERIODS * 2 * math.pi / free.natural_frequency
    motion = swing_motion(free, start, seconds, 10)
    # The energy over the moment of inertia; it is 0 at rest at the bottom.
    lift = 2 * free.natural_frequency**2 * np.sin(motion.angle / 2) ** 2
    energy = motion.speed**2 / 2 + lift
    drift = largest(energy / energy[0] - 1)
    case = f"{PERIODS} periods undamped"
    yield Row("swing", case, "keep its energy", "energy drift", drift, ENERGY_DRIFT)


def reference_swing(swing: Swing, start: float, times: Real) -> Real:
    """Angle and speed at the times, which begin at 0, by a Runge-Kutta method that is implicit."""
    damping, stiffness = swing.damping_rate, swing.natural_frequency**2
    found = solve_ivp(
        lambda _, state: [state[1], -damping * state[1] - stiffness * math.sin(state[0])],
        (0.0, times[-1]),
        [start, 0.0],
        method="Radau",
        t_eval=times,
        jac=lambda _, state: [[0.0, 1.0], [-stiffness * math.cos(state[0]), -damping]],
        rtol=REFERENCE,
        atol=REFERENCE * 1e-3,
    )
    return np.asarray(found.y)


def undamped_angle(swing: Swing, start: float, times: Real) -> Real:
    """phi in closed form, without the damping of the swing, released at rest and not upright.

    It uses Jacobi's elliptic functions: 2 asin(k sn(K - omega t, k)) with k = sin(start / 2).
    """
    k, rest = math.sin(start / 2), math.cos(start / 2) ** 2
    sn = ellipj(ellipkm1(rest) - swing.natural_frequency * times, 1 - rest)[0]
    return np.asarray(2 * np.arcsin(k * sn))


def stiffness_of(swing: Swing) -> float:
    """How stiff a swing is: the ratio of both eigenvalues of small motions, the fast one first.

    They solve x^2 + rate x + omega^2 = 0, so their product is omega^2.
    """
    half = swing.damping_rate / 2
    fast = half + math.sqrt(half**2 - swing.natural_frequency**2)
    return float((fast / swing.natural_frequency) ** 2)


def plates() -> Iterator[Row]:
    sheet = Plate()
    a, b = sheet.length, sheet.width
    middle = (a / 2, b / 2)
    rim = np.array([[0, 0], [a, b], [a, 0], [0, b / 3], [a, b / 3], [a / 3, 0], [a / 3, b]])
    grid = np.array(list(itertools.product((0.1 * a, a / 2, a), (0.3 * b, b / 2, 0.999 * b))))
    for clamped, edges in ((True, "clamped"), (False, "supported")):
        held = replace(sheet, clamped=clamped)
        scale = float(deflection(held, middle, middle))
        moved = largest(held.influence(grid, rim), held.influence(rim, grid)) / scale
        case = f"load or point on the edge, {edges}"
        yield Row("plate", case, "not move", "w / w_max", moved, 1e-14)
        must = "keep the bound of the terms left out"
        near = [(a * (0.5 + 1e-9 * i), b * (0.5 + 1e-9 * j)) for i, j in BESIDE]
        for terms in (1, 10, 100, 1000, 10_000):
            case = f"{terms} terms, 0 to 1e-09 of its sides from the load, {edges}"
            yield Row("plate", case, must, "error / w_max", *_judged(held, near, terms))
        case = f"1e-09 of its width from an edge, {edges}"
        pair = _judged(held, [(0.3 * a, 1e-9 * b), (0.3 * a, (1 - 1e-9) * b)], TERMS)
        yield Row("plate", case, must, "error / w_max", *pair)
    for ratio in (0.01, 100.0):
        strip = Plate(length=1.0, width=ratio)
        load, point = (0.5, 0.5 * ratio), (0.49, 0.5 * ratio + 0.3 * min(1, ratio))
        exact = [float(deflection(strip, place, load)) for place in (load, point)]
        found = strip.influence([point], [load], LIMIT_TERMS)[0, 0]
        error = abs(found - exact[1]) / exact[0]
        case = f"b / a of {ratio:g}, {LIMIT_TERMS} terms"
        yield Row("plate", case, AGREE, "error / w_max", error, CANCELLED)


def _judged(plate: Plate, points: list[tuple[float, float]], terms: int) -> tuple[float, float]:
    """Error and bound at that point, of a load in the middle, that is nearest to its bound."""
    load = (plate.length / 2, plate.width / 2)
    scale = float(deflection(plate, load, load))
    exact = [[float(deflection(plate, point, load))] for point in points]
    error = plate.influence(points, [load], terms) - exact
    return worst(error / scale, plate.tail(points, [load], terms) / scale + ROUNDING)


def others() -> Iterator[Row]:
    rng = np.random.default_rng(0)
    rails = np.tile([-1.0, 1.0], 500)
    codes, clipped = Conditioning(1e6).convert(read_sensor(rails, rng), REST)
    case = "alternating rails, gain 1e6"
    yield Row("conditioning", case, "stop at the rails", "code", largest(codes), -SIGNAL.low)
    yield Row("conditioning", case, "count what it clips", "not counted", 1000 - clipped, 0)
    nothing = math.nan
    invalid = accepted(
        [
            lambda: swing_motion(Swing(), nothing, 1),
            lambda: Swing(arm=nothing),
            lambda: Plate().influence([[nothing, 0.1]], [[0.1, 0.1]]),
            lambda: Plate(thickness=nothing),
            lambda: read_sensor([nothing], rng),
            lambda: Conditioning(1.0).convert([nothing], REST),
        ]
    )
    yield Row("physics", "NaN as an argument", "refuse it", "accepted of 6", invalid, 0)
