"""The physics of the two rigs: fitted sensors, and error against work for plate and swing."""

import math
from dataclasses import dataclass

import numpy as np

from golden.numbers.real import Real
from tactus.core.table import read_table
from tactus.physics.beam import Beam
from tactus.physics.digit_data import RECORDED, SENSORS
from tactus.physics.plate import Plate
from tactus.physics.plate_grid import grid_influence
from tactus.physics.strain_sensor import COLUMNS, fit_sensors, loads_from_codes, read_sensors
from tactus.physics.swing import LIGHT, METHODS, STRONG, Swing, swing_motion, undamped_angle
from tactus.report.measure.reference_swing import reference_swing
from tactus.report.measure.table import Cell, Table
from tactus.report.measure.timing import timed

TERMS = (1, 3, 10, 30, 100, 200, 300, 1000, 3000, 10_000)
LIMIT_TERMS = 1_000_000
CELLS = (10, 20, 40, 80)
# The load and the point as parts of length and width. Both are nodes of every grid.
PLACES = {"at the load": ((0.5, 0.5), (0.5, 0.5)), "beside it": ((0.3, 0.2), (0.5, 0.5))}

TOLERANCES = (1e-3, 1e-6, 1e-8, 1e-10, 1e-12)
SWING_SECONDS, SWING_RATE = 4.0, 200.0
MOST_EVALUATIONS = 15_000
DAMPING_RATIOS = (0.1, 1, 2, 3, 10, 30, 100, 1000)
DAMPING_TOLERANCE = 1e-8
ELSEWHERE = (
    "The evaluations are those of this machine. On a machine that rounds last bits differently "
    "they are up to 4 % more or fewer."
)


def beam(_: int) -> Table:
    """The sensor model of equation 3.9, fitted to the recorded vectors."""
    rig = Beam()
    table = read_table(RECORDED, [*SENSORS, *COLUMNS])
    loads = loads_from_codes(table[:, len(SENSORS) :], rig)
    spans = np.ptp(table[:, : len(SENSORS)], axis=0)
    rows: list[list[Cell]] = []
    for kind, spread in (("at a point", False), ("of its width", True)):
        sensors = fit_sensors(table, rig, spread)
        used = loads if spread else loads.at_points()
        residuals = read_sensors(sensors, used) - table[:, : len(SENSORS)]
        for name, sensor, residual, span in zip(SENSORS, sensors, residuals.T, spans, strict=True):
            rms = float(np.sqrt((residual**2).mean()))
            rows.append(
                [
                    name,
                    kind,
                    sensor.gain,
                    sensor.offset,
                    1e3 * sensor.position,
                    1e3 * rms,
                    float(100 * rms / span),
                    float(1e3 * np.abs(residual).max()),
                ]
            )
    return Table(
        "beam",
        [
            "sensor",
            "load",
            "gain V per strain",
            "offset V",
            "position mm",
            "rms mV",
            "rms % of span",
            "largest mV",
        ],
        rows,
        "Equation 3.9 was fitted to the 143 recorded vectors, for loads at a point (equation 3.5) "
        "and for loads spread over their width. The position is measured from the root of the beam "
        "of 228.6 mm. That of sensor 4 is the end of the search range, a hundred lengths outside: "
        "its reading grows with the load and hardly with the position, as no bending moment on "
        "this beam does.",
    )


def plate(_: int) -> Table:
    """The plate's deflection by the series and by finite differences, against work."""
    rig = Plate()
    size = np.array([rig.length, rig.width])
    rows: list[list[Cell]] = []
    for case, (load, point) in PLACES.items():
        points, loads = [np.multiply(point, size)], [np.multiply(load, size)]
        limit = rig.influence(points, loads, LIMIT_TERMS)[0, 0]
        for terms in TERMS:
            found, ms = timed(rig.influence, points, loads, terms)
            miss = abs(found[0, 0] / limit - 1)
            bound = rig.tail(points, loads, terms)[0, 0] / limit
            rows.append([case, "series", terms, ms, float(miss), float(bound)])
        for cells in CELLS:
            found, ms = timed(grid_influence, rig, loads[0], cells, cells)
            at = round(point[1] * cells) - 1, round(point[0] * cells) - 1
            rows.append([case, "grid", (cells - 1) ** 2, ms, abs(found[at] / limit - 1), None])
    return Table(
        "plate",
        ["point", "method", "terms, nodes", "ms", "error", "bound"],
        rows,
        f"The figures are deflections of the clamped plate of section 6.2.1 for one load and one "
        f"point. The error is relative to the sum of {LIMIT_TERMS} terms. The grid solves the "
        "plate equation with equal numbers of cells along both sides, and gives all nodes at once.",
        timed=["ms"],
    )


@dataclass(frozen=True)
class Case:
    """A swing to be integrated, and its exact solution."""

    swing: Swing
    start: float
    reference: Real


def _times() -> Real:
    return np.arange(round(SWING_SECONDS * SWING_RATE)) / SWING_RATE


def _case(damping_rate: float, start_degrees: float) -> Case:
    swing, start = Swing(damping=damping_rate * Swing().arm), math.radians(start_degrees)
    if damping_rate == 0:
        return Case(swing, start, undamped_angle(swing, start, _times()))
    return Case(swing, start, reference_swing(swing, start, _times())[0])


def _solved(case: Case, method: str, tolerance: float) -> list[Cell]:
    """The evaluations, the ms and the error, or None if the work exceeds the limit."""
    try:
        motion, ms = timed(
            swing_motion,
            case.swing,
            case.start,
            SWING_SECONDS,
            SWING_RATE,
            method=method,
            tolerance=tolerance,
            most_evaluations=MOST_EVALUATIONS,
        )
    except ArithmeticError:
        return [None, None, None]
    return [motion.evaluations, ms, float(np.abs(motion.angle - case.reference).max())]


def swing(_: int) -> Table:
    """Six integrators on three swings, against work."""
    damping = Swing().damping_rate
    cases = {
        "plain": _case(damping, 30),
        "strongly damped": _case(1e3, 30),
        "179.9 degrees": _case(0, 179.9),
    }
    return Table(
        "swing",
        ["case", "method", "tolerance", "evaluations", "ms", "error rad"],
        [
            [name, method, tolerance, *_solved(case, method, tolerance)]
            for name, case in cases.items()
            for method in METHODS
            for tolerance in TOLERANCES
        ],
        f"Appendix 7, equation 2, was solved over {SWING_SECONDS:g} s in three cases: damped at "
        f"{damping:.2g} 1/s from 30 degrees, damped at 1000 1/s from 30 degrees, and undamped from "
        f"179.9 degrees. The error is the largest one of the angle at {SWING_RATE:g} samples per "
        "second. The reference is none of the six: Gauss and Legendre's implicit method of order 6 "
        "in extended precision, extrapolated, and in the last case Jacobi's closed form. A cell is "
        "empty where a method needs more than "
        f"{MOST_EVALUATIONS} evaluations. {ELSEWHERE}",
        timed=["ms"],
    )


def swing_damping(_: int) -> Table:
    """The damping from which on an implicit method pays off."""
    natural = Swing().natural_frequency
    rows: list[list[Cell]] = []
    for ratio in DAMPING_RATIOS:
        case = _case(ratio * natural, 30)
        for method in (LIGHT, STRONG):
            rows.append([ratio, method, *_solved(case, method, DAMPING_TOLERANCE)])
    return Table(
        "swing_damping",
        ["rate / natural frequency", "method", "evaluations", "ms", "error rad"],
        rows,
        f"The swing of section 6.2.2 was solved from 30 degrees at tolerance "
        f"{DAMPING_TOLERANCE:g}, with more and more damping. The first column is kappa / I'_p "
        f"divided by {natural:.3g} rad/s. The reference and the limit of work are those of table "
        f"swing. {ELSEWHERE}",
        timed=["ms"],
    )
