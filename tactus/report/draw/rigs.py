"""Draws what the models of the two rigs give, for the pictures of measurements in the thesis."""

import math
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.figure import Figure

from golden.numbers.real import Real
from golden.numbers.units import FULL_SCALE, LOAD_G, WIDTH_MM
from tactus.core.table import read_table
from tactus.physics import GRAVITY
from tactus.physics.beam import Beam
from tactus.physics.digit_data import RECORDED, SENSORS
from tactus.physics.plate import Plate
from tactus.physics.strain_sensor import COLUMNS, fit_sensors, loads_from_codes
from tactus.physics.swing import Swing, bearing_forces, foot_forces, swing_motion
from tactus.report.draw.looks import nth
from tactus.report.draw.plot import plotted
from tactus.report.draw.svg import style
from tactus.scene import thesis_table

INCHES = (7.2, 5.6)
WIDE = (7.2, 3.0)
# These are the three narrow loads of section 3.8.2, and the heaviest of the recorded loads.
SHOWN_G = (6, 9, 11, 23)
SECONDS_UNDAMPED, SECONDS_DAMPED = 3.0, 25.0


def gauges() -> str:
    """The readings of each sensor and the fitted equation 3.9, as in Figures 3.8 to 3.11."""
    beam = Beam()
    table = read_table(RECORDED, [*SENSORS, *COLUMNS])
    fitted = fit_sensors(table, beam)
    codes = table[:, len(SENSORS) :]
    grams = np.round(codes[:, 0] / FULL_SCALE * LOAD_G)
    with style():
        figure = Figure(figsize=INCHES, layout="constrained")
        panels = figure.subplots(2, 2, sharex=True)
        for c, (axes, sensor) in enumerate(zip(panels.flat, fitted, strict=True)):
            for i, load in enumerate(SHOWN_G):
                look, rows = nth(i), np.flatnonzero(grams == load)
                loads = loads_from_codes(codes[rows], beam)
                place = loads.position / beam.length
                width = codes[rows[0], 2] / FULL_SCALE * WIDTH_MM
                label = f"{load} g, {width:.1f} mm wide"
                axes.plot(place, sensor.read(loads), color=look.colour, linewidth=0.9)
                axes.plot(
                    place,
                    table[rows, c],
                    color=look.colour,
                    marker=look.marker,
                    markersize=3,
                    linestyle="none",
                    label=label,
                )
            axes.set_title(f"sensor {c + 1}", fontsize=10)
            axes.set_ylabel("V")
        for axes in panels[1]:
            axes.set_xlabel("position of the load, 1 at the tip")
        handles, labels = panels[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(SHOWN_G))
        return plotted(figure, "gauges", "Readings along the beam: recorded, and equation 3.9")


def gauges_sentence() -> str:
    """A sentence on the distance of the lines from the markers."""
    beam = Beam()
    table = read_table(RECORDED, [*SENSORS, *COLUMNS])
    loads = loads_from_codes(table[:, len(SENSORS) :], beam)
    told = []
    for c, sensor in enumerate(fit_sensors(table, beam)):
        missed = np.abs(sensor.read(loads) - table[:, c])
        told.append(f"{100 * missed.max() / np.ptp(table[:, c]):.0f} % for sensor {c + 1}")
    return (
        "Markers are recorded readings, and lines are equation 3.9, fitted to all of them. The "
        "largest "
        f"distance in the {len(table)} rows, in percent of the sensor's span, is {', '.join(told)}."
    )


@dataclass(frozen=True)
class Deflections:
    """The deflections in mm of the beam along its length, and of two points of the plate by load.

    along, shape (n,): mm from the root.
    beams: The deflection for each load in g. Downwards is negative.
    loads, shape (m,): kg on the plate.
    plate, shape (m,): The deflection of each point, in the direction of the load, which is in the
        middle.
    """

    along: Real
    beams: dict[float, Real]
    loads: Real
    plate: dict[str, Real]


def deflections() -> Deflections:
    """Equation 3.1 for the loads of Figure 3.2, and equation 6.3 for those of Figure 6.4."""
    beam, plate = Beam(), Plate()
    along = np.linspace(0, beam.length, 46)
    grams = thesis_table("beam")["deflection_loads_g"]
    first, last = thesis_table("swing")["plate_loads_kg"]
    loads = np.arange(first, last + 1)
    middle = plate.length / 2, plate.width / 2
    gauge = thesis_table("swing")["plate_gauge_mm"]
    points = {"in the middle": middle, f"{gauge:g} mm from an end": (gauge / 1e3, middle[1])}
    softness = plate.influence(list(points.values()), [middle])[:, 0]
    return Deflections(
        1e3 * along,
        {g: 1e3 * beam.deflection(along, g / 1e3, beam.length) for g in grams},
        loads,
        {at: 1e3 * s * GRAVITY * loads for at, s in zip(points, softness, strict=True)},
    )


def deflections_drawn(found: Deflections) -> str:
    """The beam and the plate under the loads with which the thesis verified them."""
    with style():
        figure = Figure(figsize=WIDE, layout="constrained")
        left, right = figure.subplots(1, 2)
        for i, (grams, line) in enumerate(found.beams.items()):
            left.plot(found.along, line, color=nth(i).colour, label=f"{grams:g} g")
        left.legend()
        left.set_title("beam, load at the tip", fontsize=10)
        left.set_xlabel("mm from the root")
        left.set_ylabel("deflection, mm")
        for i, (point, line) in enumerate(found.plate.items()):
            right.plot(found.loads, line, marker=nth(i).marker, color=nth(i).colour, label=point)
        right.legend()
        right.set_title("plate, load in the middle", fontsize=10)
        right.set_xlabel("kg")
        right.set_ylabel("deflection, mm")
        return plotted(figure, "deflections", "Deflection of the beam and of the plate by theory")


def deflections_sentence(found: Deflections) -> str:
    """A sentence on the ends of the lines."""
    tips = ", ".join(f"{-line[-1]:.1f} mm under {g:g} g" for g, line in found.beams.items())
    plate = " and ".join(f"{line[-1]:.2f} mm {point}" for point, line in found.plate.items())
    return (
        f"By theory, with 200 GPa, the tip of the beam sinks by {tips}. The plate sinks by {plate} "
        f"under {found.loads[-1]:g} kg, in proportion to the load."
    )


@dataclass(frozen=True)
class Forces:
    """The forces of the swing in N over time, at the bearing, at one foot and at both feet.

    time, horizontal, downward, foot, shape (n,): The motion without damping.
    damped_time, feet, shapes (m,) and (2, m): The motion with damping.
    angle, shape (m,): The angle in rad, with damping.
    """

    time: Real
    horizontal: Real
    downward: Real
    foot: Real
    damped_time: Real
    feet: Real
    angle: Real


def forces() -> Forces:
    """Equations 6.4 and 6.5, with the start angle and the damping of Figures 6.6 and 6.7."""
    figures = thesis_table("swing")
    start = math.radians(figures["forces_start_degrees"])
    free, damped = (replace(Swing(), damping=damping) for damping in figures["forces_damping"])
    still = swing_motion(free, start, SECONDS_UNDAMPED)
    motion = swing_motion(damped, start, SECONDS_DAMPED)
    return Forces(
        still.time,
        *bearing_forces(free, still.angle, still.speed),
        foot_forces(free, still.angle, still.speed)[1],
        motion.time,
        np.array(foot_forces(damped, motion.angle, motion.speed)),
        motion.angle,
    )


def forces_drawn(found: Forces) -> str:
    """The forces at bearing and feet against time."""
    figures = thesis_table("swing")
    with style():
        figure = Figure(figsize=INCHES, layout="constrained")
        above, below = figure.subplots(2, 1)
        lines = {"F_x": found.horizontal, "F_y": found.downward, "N_y2": found.foot}
        for i, (name, line) in enumerate(lines.items()):
            above.plot(found.time, line, color=nth(i).colour, label=name)
        for i, line in enumerate(found.feet):
            below.plot(
                found.damped_time, line, color=nth(i).colour, linewidth=0.8, label=f"N_y{i + 1}"
            )
        for axes in (above, below):
            axes.set_ylabel("force, N")
            axes.legend(loc="upper right", ncols=3)
            axes.set_ylim(top=1.25 * axes.dataLim.ymax)
        start, (_, damping) = figures["forces_start_degrees"], figures["forces_damping"]
        above.set_title(f"released at {start:g} degrees, no damping", fontsize=10)
        below.set_title(f"released at {start:g} degrees, damping of {damping:g}", fontsize=10)
        below.set_xlabel("time, s")
        return plotted(figure, "forces", "Forces of the swing on its bearing and on its feet")


def forces_sentence(found: Forces) -> str:
    """A sentence on the largest forces, and on how alike both sides are half a period apart."""
    ends = ", ".join(
        f"{name} between {line.min():.0f} and {line.max():.0f} N"
        for name, line in (
            ("F_x", found.horizontal),
            ("F_y", found.downward),
            ("N_y2", found.foot),
        )
    )
    late = found.damped_time >= found.damped_time[-1] - 2
    left = np.degrees(np.abs(found.angle[late]).max())
    alike = float(np.asarray(np.corrcoef(found.feet))[0, 1])
    return (
        f"Without damping, the forces are {ends}. With damping, the swing has fallen to {left:.0f} "
        f"degrees after {SECONDS_DAMPED:g} s, and the forces of the two sides are opposite at all "
        f"times (correlation {alike:.2f}). Below 0 N a frame without weight would lift its foot."
    )
