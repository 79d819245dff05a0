"""Draws the pictures of docs/error-against-run-time.md: errors against their cost."""

from collections.abc import Mapping
from typing import Any

from matplotlib.figure import Figure

from tactus.report.draw.axes import Axes
from tactus.report.draw.discs import PRINTED, SCAN_CLOCKS
from tactus.report.draw.drawing import picture, text
from tactus.report.draw.findings import Row, groups, number, rows_of
from tactus.report.draw.looks import Look, activation_look
from tactus.report.draw.named import Named, drawn, front
from tactus.report.draw.plot import plotted
from tactus.report.draw.plots import Plot, Points, side_by_side
from tactus.report.draw.svg import PAGE_INCHES, style
from tactus.report.measure.table import Table
from tactus.scene import thesis_table

WORST, AFTER = "largest %", "clocks after the last sample"
# With this rho the regression of Pade is stable up to its gate.
SETTLING = (4, 4.5, 5, 6, 8)
CASES = {
    "plain": "from 30 degrees",
    "strongly damped": "damped at 1000 1/s",
    "179.9 degrees": "from 179.9 degrees",
}

_UNITS = "largest error, units of $2^{-13}$"
_METHODS = {"levenberg-marquardt": "#0072b2", "scg": "#d55e00"}
_STARTS = ("o", "s", "^")
_CASCADES = {"cascade A": Look("#000000", "D"), "cascade B": Look("#009e73", "v")}


def network_rows(table: Table) -> list[Row]:
    """The networks of the digit that have recorded cells, least error first.

    Instruments are left out, because they wait for their scan.
    """
    found = [
        row
        for row in rows_of(table, data="appendix2")
        if row["LUT"] is not None and number(row, "interval clocks") < SCAN_CLOCKS
    ]
    # Two engines with the same networks have the same error, except for the last bits of a sum.
    return sorted(found, key=lambda row: (round(number(row, WORST), 6), number(row, "LUT")))


def form(row: Row) -> str:
    """The design of a network, and whether its engine has a multiplier."""
    serial = row["design"] == "engine" and row["multiplier"] == 0
    return f"{row['design']}{' without multiplier' if serial else ''}"


def network_points(table: Table) -> list[Named]:
    """Networks of four outputs, by clocks and error, and the printed errors of the thesis.

    The thesis prints no time for a frame. Its networks stand at the clocks of those that are
    rebuilt with its hidden nodes, in its design and arithmetic.
    """
    rows = {scene_of(row): row for row in network_rows(table) if row["outputs"] == 4}
    found = [Named(name, number(row, AFTER), number(row, WORST)) for name, row in rows.items()]
    return found + [
        Named(f"{name}, as printed", number(rows[scene], AFTER), error)
        for name, (scene, error) in printed_errors().items()
    ]


def scene_of(row: Row) -> str:
    """The name of a row's scene, without its folder."""
    return str(row["scene"]).removeprefix("comparison/")


def printed_errors() -> dict[str, tuple[str, float]]:
    """For each printed network: our scene of the same form, and its error in simulation.

    The error is that of the worst output.
    """
    return {
        f"thesis, {name}": (scene, max(thesis_table(key)["simulation"]))
        for name, (key, scene) in PRINTED.items()
    }


def networks(table: Table) -> str:
    """The worst output of every network against the clocks after the last sample."""
    points = network_points(table)
    title = "The same four outputs: error against clocks"
    axes = Axes(46, 58, 660, 330, (4, 4000), (0.3, 20))
    clock = float(thesis_table("board")["clock_mhz"])
    body = [text((6, 18), title, 13, font_weight="bold")]
    across = f"clocks from the last sample to the last output; {clock:g} are 1 µs for the thesis"
    body += axes.drawn(across, "error of the worst output, %")
    said = f"{title}. Not beaten on both axes: {', '.join(one.name for one in front(points))}."
    return picture(said, (720, 430), [*body, *drawn(points, axes)], widest=860)


def activations(table: Table) -> str:
    """The largest error of every activation against clocks, and against cells."""
    rows = activation_rows(table)
    plots = []
    for column, across, linear in (
        ("latency clocks", "latency, clocks", ""),
        ("LUT", "Virtex-II LUTs, where recorded", "x"),
    ):
        points = groups(rows, _activation, column, "largest units")
        looks = {label: activation_look(*label.rsplit(", ", 1)) for label in points}
        plots.append(_panel("", across, _UNITS, points, joined=False, linear=linear, looks=looks))
    return side_by_side("activations", "Activations: largest error against clocks and LUTs", plots)


def activation_rows(table: Table) -> list[Row]:
    """Every activation as hardware, with its own options."""
    return [
        row
        for row in rows_of(table)
        if row["latency clocks"] is not None and "," not in str(row["scheme"])
    ]


def pade(table: Table) -> str:
    """Mean and largest error of the Pade regression against its iterations, for each rho."""
    rows = [row for row in rows_of(table, arithmetic="exact") if row["rho"] in SETTLING]
    plots = [
        _panel("", "iterations", up, _by(rows, "rho", "iterations", column, "rho "))
        for column, up in (("mean %", "mean error, %"), ("largest units", _UNITS))
    ]
    return side_by_side("pade", "Pade: error against iterations", plots, 5)


def training(table: Table) -> str:
    """The validation error against processor time, for the optimisers and the two cascades."""
    one: list[Row] = []
    many: list[Row] = []
    for row in rows_of(table):
        (one if row["output"] == "all" else many).append(row)

    def descent(row: Row) -> str:
        return f"{row['method']}, start {row['restart']}"

    curves = groups(one, descent, "CPU s", "validation %")
    looks = {
        descent(row): Look(_METHODS[str(row["method"])], _STARTS[int(number(row, "restart"))])
        for row in one
    }
    starts = _by(many, "method", "CPU s", "validation %")
    up = "validation error, % rms"
    plots = [
        _panel("Two optimisers, one network", "processor time, s", up, curves, looks=looks),
        _panel(
            "Two ways to train a cascade",
            "processor time of each start, s",
            up,
            starts,
            joined=False,
            looks=_CASCADES,
        ),
    ]
    return side_by_side("training", "Training: validation error against processor time", plots)


def swing(table: Table) -> str:
    """Six integrators on three swings against run time."""
    plots = [
        _panel(
            title,
            "run time, ms",
            "largest error, rad",
            _by(rows_of(table, case=case), "method", "ms", "error rad"),
        )
        for case, title in CASES.items()
    ]
    return side_by_side("swing", "Swing: error of six integrators against run time", plots, 6)


def damping(table: Table) -> str:
    """The run time and the error of both default integrators against damping."""
    across = "damping rate, natural frequencies"
    plots = [
        _panel("", across, up, _by(rows_of(table), "method", "rate / natural frequency", column))
        for column, up in (("ms", "run time, ms"), ("error rad", "largest error, rad"))
    ]
    return side_by_side("damping", "Swing: run time and error against damping", plots)


def plate(table: Table) -> str:
    """The error of the plate by series and by grid, against terms and against run time."""

    def label(row: Row) -> str:
        return f"{row['method']}, {row['point']}"

    plots = [
        _panel("", across, "error, part of the deflection", groups(rows, label, column, "error"))
        for rows in [rows_of(table)]
        for column, across in (
            ("terms, nodes", "terms of the series, nodes of the grid"),
            ("ms", "run time, ms"),
        )
    ]
    return side_by_side("plate", "Plate: error against terms and run time", plots)


def profile(table: Table) -> str:
    """Equation 3.17 against terms and against run time."""
    up = "largest error, part of the load"
    plots = [
        _panel("", across, up, _by(rows_of(table), "case", column, "error / d", "curve "))
        for column, across in (("terms", "terms"), ("ms", "run time of 160 positions, ms"))
    ]
    return side_by_side("profile", "Load profile: error against terms and run time", plots)


def simulators(table: Table) -> str:
    """The frames per second of everything that computes the default network, fastest first."""
    rows = sorted(rows_of(table), key=lambda row: number(row, "frames a second"))
    rates = [number(row, "frames a second") for row in rows]
    title = "Simulators: frames a second of the same network"
    with style():
        width, height = PAGE_INCHES
        figure = Figure(figsize=(width, 0.75 * height), layout="constrained")
        axes = figure.add_subplot()
        axes.barh([str(row["simulator"]) for row in rows], rates, color="#0072b2", height=0.6)
        for place, rate in enumerate(rates):
            axes.annotate(
                rounded(rate),
                (rate, place),
                xytext=(4, 0),
                textcoords="offset points",
                va="center",
            )
        axes.set_xscale("log")
        axes.set_xlim(0.1, 20 * max(rates))
        axes.set_xlabel("frames a second")
        return plotted(figure, "simulators", title)


def rounded(value: float, digits: int = 2) -> str:
    """A figure with so many digits, as pages write it: 1,700 or 0.41 or 1.5e-6."""
    short = f"{value:.{digits}g}"
    if abs(float(short)) >= 10 ** (digits - 1):
        return f"{float(short):,.0f}"
    mantissa, _, power = short.partition("e")
    return f"{mantissa}e{int(power)}" if power else short


def _panel(title: str, across: str, up: str, points: Mapping[str, Points], **how: Any) -> Plot:
    return Plot("panel", title, across, up, points, "", [], **how)


def _by(
    rows: list[Row], column: str, x: str, y: str, prefix: str = ""
) -> dict[str, list[tuple[float, float]]]:
    """The points (x, y), grouped by the value of a column."""
    return groups(rows, lambda row: f"{prefix}{row[column]}", x, y)


def _activation(row: Row) -> str:
    return f"{row['scheme']}, {row['arithmetic']}"
