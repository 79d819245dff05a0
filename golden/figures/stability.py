"""Stiff and extreme cases of the physics: what must happen, and what did."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from golden.figures.table import Cell, Table
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
from golden.visualisation.functions import harmonic_limit, harmonic_load, harmonic_tail

PERIODS = 1000
ENERGY_DRIFT = 1e-8


@dataclass(frozen=True)
class Row:
    """One case that was run: a figure and the bound that it must not exceed."""

    model: str
    case: str
    figure: str
    value: float
    bound: float

    @property
    def holds(self) -> bool:
        """Whether the figure keeps its bound; NaN does not."""
        return bool(self.value <= self.bound)


def _largest(*values: ArrayLike) -> float:
    """Largest magnitude; infinite where any value is not finite, so that no bound holds."""
    together = np.concatenate([np.asarray(v, dtype=np.float64).ravel() for v in values])
    return float(np.abs(together).max()) if np.isfinite(together).all() else math.inf


def _swings() -> Iterator[Row]:
    start = math.radians(30)
    for rate in (1e2, 1e4, 1e6):
        heavy = Swing(damping=rate * Swing().arm)
        motion = swing_motion(heavy, start, 5)
        # Overdamped: no kinetic energy to speak of, so the angle creeps down and never rises.
        rise = max(0.0, float(np.diff(motion.angle).max()))
        yield Row("swing", f"damped at {rate:g} 1/s", "largest rise rad", rise, 1e-9)
        forces = _largest(*foot_forces(heavy, motion.angle, motion.speed))
        yield Row("swing", f"damped at {rate:g} 1/s", "foot force N", forces, 200)
    # In units of its own natural frequency every undamped pendulum moves alike.
    for arm in (1e-3, 1e-2, 1.0, 10.0, 100.0):
        other = Swing(arm=arm, damping=0)
        seconds = 10 / other.natural_frequency
        motion = swing_motion(other, start, seconds, 200 / seconds)
        miss = _largest(motion.angle - undamped_angle(other, start, motion.time))
        yield Row("swing", f"arm of {arm:g} m", "error rad", miss, 1e-8)
    free = Swing(damping=0)
    steep = math.radians(179.9)
    motion = swing_motion(free, steep, 4)
    miss = _largest(motion.angle - undamped_angle(free, steep, motion.time))
    yield Row("swing", "from 179.9 degrees", "error rad", miss, 1e-6)
    forces = _largest(*bearing_forces(free, motion.angle, motion.speed))
    # Energy bounds the pull: D a_g (3 - 2 cos(start)) at the bottom.
    most = float(free.mass * 9.80665 * (3 - 2 * math.cos(steep)))
    yield Row("swing", "from 179.9 degrees", "bearing force N", forces, most * (1 + 1e-4))
    motion = swing_motion(free, math.pi, 3)
    yield Row("swing", "upright", "angle from upright rad", _largest(motion.angle - math.pi), 1e-8)
    motion = swing_motion(free, 0.0, 3)
    yield Row("swing", "hanging", "angle rad", _largest(motion.angle), 0)
    seconds = PERIODS * 2 * math.pi / free.natural_frequency
    motion = swing_motion(free, start, seconds, 10)
    energy = free.energy(motion.angle, motion.speed)
    drift = _largest(energy / energy[0] - 1)
    yield Row("swing", f"{PERIODS} periods undamped", "energy drift", drift, ENERGY_DRIFT)


def _plates() -> Iterator[Row]:
    sheet = Plate()
    a, b = sheet.length, sheet.width
    middle = np.array([[a / 2, b / 2]])
    normal = sheet.influence(middle, middle)[0, 0] * sheet.stiffness
    for thickness in (1e-6, 1e-3, 1.0):
        other = replace(sheet, thickness=thickness)
        found = other.influence(middle, middle)[0, 0] * other.stiffness
        change = _largest(found / normal - 1)
        yield Row("plate", f"{thickness:g} m thick", "change of D w", change, 1e-12)
    rim = np.array([[0, 0], [a, b], [a, 0], [0, b / 3], [a, b / 3], [a / 3, 0], [a / 3, b]])
    grid = np.array(list(itertools.product((0.1 * a, a / 2, a), (0.3 * b, b / 2, 0.999 * b))))
    for clamped, edges in ((True, "clamped"), (False, "supported")):
        held = replace(sheet, clamped=clamped)
        scale = held.influence(middle, middle)[0, 0]
        moved = _largest(held.influence(grid, rim), held.influence(rim, grid)) / scale
        yield Row("plate", f"load or point on the edge, {edges}", "w / w_max", moved, 1e-14)
        limit = held.influence(grid, grid, 100_000)
        for terms in (1, 10, 100, 1000, 10_000):
            miss = np.abs(held.influence(grid, grid, terms) - limit)
            over = _largest(np.maximum(miss - held.tail(grid, grid, terms), 0)) / scale
            yield Row("plate", f"{terms} terms, {edges}", "error beyond bound / w_max", over, 1e-12)
    for ratio in (0.01, 100.0):
        strip = Plate(length=1.0, width=ratio)
        places = np.array([[x, ratio * y] for x in (0.1, 0.5) for y in (0.01, 0.3, 0.5)])
        found = strip.influence(places, places)
        skew = _largest(found - found.T) / found.max()
        yield Row("plate", f"b / a of {ratio:g}", "w(p, q) - w(q, p) / w_max", skew, 1e-9)


def _others() -> Iterator[Row]:
    rig = Beam()
    ends = np.array([0.0, rig.length])
    for thickness in (1e-6, 1.0):
        sheet = replace(rig, thickness=thickness)
        found = sheet.deflection(ends[:, None], 0.023, ends) * sheet.stiffness
        normal = rig.deflection(ends[:, None], 0.023, ends) * rig.stiffness
        change = _largest(found - normal) / _largest(normal)
        yield Row("beam", f"{thickness:g} m thick, root and tip", "change of E I v", change, 1e-12)
    rng = np.random.default_rng(0)
    sensor = ReflectiveSensor()
    rails = np.tile([-1.0, 1.0], 500)
    codes, clipped = Conditioning(1e6).convert(sensor.read(rails, rng), sensor.rest)
    yield Row("conditioning", "alternating rails, gain 1e6", "code", _largest(codes), -SIGNAL.low)
    yield Row("conditioning", "alternating rails, gain 1e6", "not clipped", 1000 - clipped, 0)
    jumps = np.array([0.2, 0.8])
    at = np.concatenate([jumps, np.nextafter(jumps, 0), np.nextafter(jumps, 1)])
    for terms in (1, 10_000):
        miss = np.abs(harmonic_load(at, 0.5, 0.5, 0.3, terms) - harmonic_limit(at, 0.5, 0.5, 0.3))
        over = _largest(np.maximum(miss - harmonic_tail(at, 0.5, 0.5, 0.3, terms), 0))
        yield Row(
            "equation 3.17", f"at its jumps, {terms} terms", "error beyond bound", over, 1e-12
        )


def stability(_: int) -> Table:
    """Every stiff and extreme case of the physics, with its bound."""
    rows: list[list[Cell]] = [
        [
            row.model,
            row.case,
            row.figure,
            row.value if math.isfinite(row.value) else None,
            row.bound,
            "yes" if row.holds else "no",
        ]
        for row in (*_swings(), *_plates(), *_others())
    ]
    return Table(
        "stability",
        ["model", "case", "figure", "value", "bound", "holds"],
        rows,
        "Each case is run with the defaults of the models; a value that is NaN or infinite is left "
        "out and breaks its bound. Foot forces of a heavily damped swing stay below twice its "
        "weight; angles are compared with Jacobi's closed form; D w is the deflection times the "
        "plate's stiffness.",
    )
