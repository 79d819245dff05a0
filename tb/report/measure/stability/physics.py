"""Stiff and extreme cases of the physics: swing, plate, beam, conditioning."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from golden.physics.beam import Beam
from golden.physics.conditioning import Conditioning, ReflectiveSensor
from golden.physics.plate import Plate
from golden.physics.swing import (
    Swing,
    bearing_forces,
    foot_forces,
    swing_motion,
    undamped_angle,
)
from golden.precision import SIGNAL
from tb.report.measure.stability.case import Row, accepted, largest

PERIODS = 1000
ENERGY_DRIFT = 1e-8
LIMIT_TERMS = 100_000


def swings() -> Iterator[Row]:
    start = math.radians(30)
    for rate in (1e2, 1e4, 1e6):
        heavy = Swing(damping=rate * Swing().arm)
        motion = swing_motion(heavy, start, 5)
        case = f"damped at {rate:g} 1/s"
        # An overdamped swing has hardly any kinetic energy, so its angle falls slowly and never
        # rises.
        rise = max(0.0, float(np.diff(motion.angle).max()))
        yield Row("swing", case, "creep down, never rise", "largest rise rad", rise, 1e-9)
        forces = largest(*foot_forces(heavy, motion.angle, motion.speed))
        yield Row("swing", case, "press less than twice its weight", "foot force N", forces, 200)
    # Measured in units of its natural frequency, every undamped pendulum moves alike.
    jacobi = "follow Jacobi's closed form"
    for arm in (1e-3, 1e-2, 1.0, 10.0, 100.0):
        other = Swing(arm=arm, damping=0)
        seconds = 10 / other.natural_frequency
        motion = swing_motion(other, start, seconds, 200 / seconds)
        miss = largest(motion.angle - undamped_angle(other, start, motion.time))
        yield Row("swing", f"arm of {arm:g} m", jacobi, "error rad", miss, 1e-8)
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
    energy = free.energy(motion.angle, motion.speed)
    drift = largest(energy / energy[0] - 1)
    case = f"{PERIODS} periods undamped"
    yield Row("swing", case, "keep its energy", "energy drift", drift, ENERGY_DRIFT)


def plates() -> Iterator[Row]:
    sheet = Plate()
    a, b = sheet.length, sheet.width
    middle = np.array([[a / 2, b / 2]])
    normal = sheet.influence(middle, middle)[0, 0] * sheet.stiffness
    for thickness in (1e-6, 1e-3, 1.0):
        other = replace(sheet, thickness=thickness)
        found = other.influence(middle, middle)[0, 0] * other.stiffness
        change = largest(found / normal - 1)
        case = f"{thickness:g} m thick"
        yield Row("plate", case, "give way as 1 / D", "change of D w", change, 1e-12)
    rim = np.array([[0, 0], [a, b], [a, 0], [0, b / 3], [a, b / 3], [a / 3, 0], [a / 3, b]])
    grid = np.array(list(itertools.product((0.1 * a, a / 2, a), (0.3 * b, b / 2, 0.999 * b))))
    within = "keep the bound of the terms left out"
    for clamped, edges in ((True, "clamped"), (False, "supported")):
        held = replace(sheet, clamped=clamped)
        scale = held.influence(middle, middle)[0, 0]
        moved = largest(held.influence(grid, rim), held.influence(rim, grid)) / scale
        case = f"load or point on the edge, {edges}"
        yield Row("plate", case, "not move", "w / w_max", moved, 1e-14)
        limit = held.influence(grid, grid, LIMIT_TERMS)
        for terms in (1, 10, 100, 1000, 10_000):
            miss = np.abs(held.influence(grid, grid, terms) - limit)
            over = largest(np.maximum(miss - held.tail(grid, grid, terms), 0)) / scale
            case = f"{terms} terms, {edges}"
            yield Row("plate", case, within, "error beyond bound / w_max", over, 1e-12)
        for beside in (1e-9, 1e-6, 1e-3):
            near = middle + beside * np.array([[a, 0], [0, b], [a, b]])
            miss = np.abs(held.influence(near, middle) - held.influence(near, middle, LIMIT_TERMS))
            over = largest(np.maximum(miss - held.tail(near, middle), 0)) / scale
            case = f"{beside:g} of its sides from the load, {edges}"
            yield Row("plate", case, within, "error beyond bound / w_max", over, 1e-12)
    for ratio in (0.01, 100.0):
        strip = Plate(length=1.0, width=ratio)
        places = np.array([[x, ratio * y] for x in (0.1, 0.5) for y in (0.01, 0.3, 0.5)])
        found = strip.influence(places, places)
        skew = largest(found - found.T) / found.max()
        must = "obey w(p, q) = w(q, p)"
        yield Row("plate", f"b / a of {ratio:g}", must, "difference / w_max", skew, 1e-9)


def others() -> Iterator[Row]:
    rig = Beam()
    ends = np.array([0.0, rig.length])
    for thickness in (1e-6, 1.0):
        sheet = replace(rig, thickness=thickness)
        found = sheet.deflection(ends[:, None], 0.023, ends) * sheet.stiffness
        normal = rig.deflection(ends[:, None], 0.023, ends) * rig.stiffness
        change = largest(found - normal) / largest(normal)
        case = f"{thickness:g} m thick, root and tip"
        yield Row("beam", case, "give way as 1 / (E I)", "change of E I v", change, 1e-12)
    rng = np.random.default_rng(0)
    sensor = ReflectiveSensor()
    rails = np.tile([-1.0, 1.0], 500)
    codes, clipped = Conditioning(1e6).convert(sensor.read(rails, rng), sensor.rest)
    case = "alternating rails, gain 1e6"
    yield Row("conditioning", case, "stop at the rails", "code", largest(codes), -SIGNAL.low)
    yield Row("conditioning", case, "count what it clips", "not counted", 1000 - clipped, 0)
    nothing = math.nan
    invalid = accepted(
        [
            lambda: swing_motion(Swing(), nothing, 1),
            lambda: Swing(arm=nothing),
            lambda: Plate().influence([[nothing, 0.1]], [[0.1, 0.1]]),
            lambda: Beam().deflection(0.1, nothing, 0.1),
            lambda: sensor.read([nothing], rng),
            lambda: Conditioning(1.0).convert([nothing], sensor.rest),
        ]
    )
    yield Row("physics", "NaN as an argument", "refuse it", "accepted of 6", invalid, 0)
