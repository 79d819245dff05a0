"""Draws the pictures of docs/error-against-run-time.md: errors against their cost."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from matplotlib.figure import Figure

from golden.scene import thesis_table
from tb.report.draw.findings import Row, groups, number, rows_of
from tb.report.draw.looks import Look, activation_look
from tb.report.draw.plot import plotted
from tb.report.draw.plots import Plot, Points, side_by_side
from tb.report.draw.svg import PAGE_INCHES, style
from tb.report.measure.table import Table

# The clocks of a scan of the thesis' front end, within which its networks must finish.
SCAN_CLOCKS = 4096
PRINTED = {"thesis, single": "digit.hybrid", "thesis, cascade": "digit.cascade_b"}
WORST = "largest %"
# With this rho the regression of Pade is stable up to its gate.
SETTLING = (4, 4.5, 5, 6, 8)
CASES = {
    "plain": "from 30 degrees",
    "strongly damped": "damped at 1000 1/s",
    "179.9 degrees": "from 179.9 degrees",
}

_COLOURS = {
    "engine": "#0072b2",
    "engine without multiplier": "#56b4e9",
    "lanes": "#e69f00",
    "hybrid": "#000000",
    "adder_graph": "#009e73",
    "table_graph": "#f0e442",
    "parallel": "#cc79a7",
    "thesis": "#d55e00",
}
_MARKERS = {"cascade": "o", "multiple": "^", "single": "s"}
_THESIS = ", 14 bits"
_UNITS = "largest error, units of $2^{-13}$"
_METHODS = {"levenberg-marquardt": "#0072b2", "scg": "#d55e00"}
_STARTS = ("o", "s", "^")
_CASCADES = {"cascade A": Look("#000000", "D"), "cascade B": Look("#009e73", "v")}


def network_rows(table: Table) -> list[Row]:
    """The networks of the digit within a scan that have recorded cells, least error first."""
    found = [
        row
        for row in rows_of(table, data="appendix2")
        if row["LUT"] is not None and number(row, "clocks a frame") < SCAN_CLOCKS
    ]
    # Two engines with the same networks have the same error, except for the last bits of a sum.
    return sorted(found, key=lambda row: (round(number(row, WORST), 6), number(row, "LUT")))


def form(row: Row) -> str:
    """The design of a network, and whether its engine has a multiplier."""
    serial = row["design"] == "engine" and row["multiplier"] == 0
    return f"{row['design']}{' without multiplier' if serial else ''}"


def printed_errors() -> dict[str, float]:
    """The error of the worst output of the simulated networks that the thesis prints."""
    return {name: max(thesis_table(key)["simulation"]) for name, key in PRINTED.items()}


def networks(table: Table) -> str:
    """The worst output of every network against clocks, and against microseconds."""
    rows = [row for row in network_rows(table) if row["outputs"] in (2, 4)]
    clock = float(thesis_table("board")["clock_mhz"])
    plots = []
    for column, across, unit in (
        ("clocks a frame", f"clocks a frame ({clock:g} are 1 µs on the thesis' board)", 1.0),
        ("us on an ECP5", "µs a frame, at the clock that each reaches on an ECP5", clock),
    ):
        points: dict[str, Points] = {**groups(rows, _network, column, WORST)}
        points |= {name: [(SCAN_CLOCKS / unit, error)] for name, error in printed_errors().items()}
        looks = {label: _look(label) for label in points}
        up = "error of the worst output, %"
        plots.append(_panel("", across, up, points, joined=False, looks=looks))
    return side_by_side("networks", "Networks: error against clocks and microseconds", plots, 3)


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


def _network(row: Row) -> str:
    thesis = _THESIS if row["precision"] == "thesis" else ""
    few = "" if row["outputs"] == 4 else ", 2 outputs"
    return f"{form(row)}, {row['arrangement']}{few}{thesis}"


def _look(label: str) -> Look:
    kind, arrangement = label.split(", ")[:2]
    return Look(_COLOURS[kind], _MARKERS[arrangement], not label.endswith(_THESIS))


def _activation(row: Row) -> str:
    return f"{row['scheme']}, {row['arithmetic']}"
