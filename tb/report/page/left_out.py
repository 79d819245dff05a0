"""The content of docs/left-out.md: what scenes leave out, and which sensors they do not need."""

from __future__ import annotations

from collections.abc import Sequence

from golden.scene import load_scene
from tb.common.where import block_names
from tb.report.draw.findings import Row, number, rows_of
from tb.report.draw.plots import Plot
from tb.report.measure.left_out import LEAN, WHOLE
from tb.report.measure.sensors_dropped import EACH, IN_ORDER, PRINTED, SCENE, WORST
from tb.report.measure.table import Table

CELLS = {"LUT": "LUTs", "flip-flop": "flip-flops", "multiplier": "multipliers"}
UNKNOWN = "not recorded"


def headline(scenes: Table, dropped: Table) -> str:
    """What the demo's scene leaves out, and the sensor that it needs least."""
    (row,) = rows_of(scenes, scene=SCENE)
    sensors, needed = load_scene(SCENE).sensors, fewest(dropped)
    return (
        f"**Scene `{SCENE}` uses {row['blocks']} of the {len(block_names())} blocks, and takes "
        f"{_of(row, 'LUT')} LUTs that the same\nengine takes with everything built in. Of its "
        f"{len(sensors)} sensors, {len(needed)} are enough: {' and '.join(needed)}.**"
    )


def scene_rows(scenes: Table) -> str:
    """A row for every shipped scene: complete, as it is, and what it saves."""
    heads = ["scene", "design", "blocks"]
    for name in CELLS.values():
        heads += [f"{name} whole", "as it is", "saved"]
    heads += ["clocks whole", "as it is", "words whole", "as it is"]
    lines = [_row(heads), f"|{'---|' * len(heads)}"]
    for row in rows_of(scenes):
        cells = [f"`{row['scene']}`", str(row["design"]), str(row["blocks"])]
        for kind in CELLS:
            cells += _saved(row, kind)
        for kind in ("clocks a frame", "words"):
            cells += [f"{number(row, f'{kind}, {how}'):,.0f}" for how in (WHOLE, LEAN)]
        lines.append(_row(cells))
    return "\n".join(lines)


def sensor_rows(dropped: Table, way: str) -> str:
    """The errors of each output without some of the sensors."""
    outputs = list(dict.fromkeys(str(row["output"]) for row in rows_of(dropped)))
    lines = [
        _row(["left out", "sensors that are left", *(f"{name}, %" for name in outputs)]),
        f"|{'---|' * (2 + len(outputs))}",
    ]
    rows = _all_in_order(dropped) if way == IN_ORDER else rows_of(dropped, way=way)
    steps = dict.fromkeys((row["left out"], row["kept"]) for row in rows)
    for name, kept in steps:
        found = {str(row["output"]): row for row in rows if row["kept"] == kept}
        lines.append(_row([str(name), str(kept), *(_range(found[output]) for output in outputs)]))
    return "\n".join(lines)


def sensors_plot(dropped: Table) -> Plot:
    """The error of each output against the number of remaining sensors."""
    rows = _all_in_order(dropped)
    groups: dict[str, list[tuple[float, float]]] = {}
    for row in rows:
        point = number(row, "sensors"), number(row, "mean %")
        groups.setdefault(str(row["output"]), []).append(point)
    worst = dict(groups.pop(WORST))
    told = ", ".join(f"{count:g}: {worst[count]:.2g} %" for count in sorted(worst, reverse=True))
    return Plot(
        "sensors_dropped",
        "Sensors left out one after another",
        "sensors that are left",
        "mean error on held-out rows, %",
        groups,
        f"The worst output by number of sensors: {told}.",
        ["sensors_dropped"],
        linear="x",
    )


def nodes_rows(nodes: Table) -> str:
    """The errors with two, three and four sensors, beside those of the thesis."""
    heads = ["sensors", "thesis: best hidden nodes", "its least error", "ours with as many"]
    heads += ["ours, 4 to 25 hidden nodes", "ours on test rows, 4 to 25"]
    lines = [_row(heads), f"|{'---|' * len(heads)}"]
    for sensors, (best, printed) in PRINTED.items():
        rows = rows_of(nodes, sensors=sensors)
        there = next(row for row in rows if row["hidden"] == best)
        cells = [str(sensors), str(best), _millionths(printed)]
        for part, found in (("validation", [there]), ("validation", rows), ("test", rows)):
            mean = sum(number(row, f"{part} mean") for row in found) / len(found)
            least = min(number(row, f"{part} least") for row in found)
            most = max(number(row, f"{part} most") for row in found)
            cells.append(f"{_millionths(mean)} ({_millionths(least)} to {_millionths(most)})")
        lines.append(_row(cells))
    return "\n".join(lines)


def nodes_plot(nodes: Table) -> Plot:
    """The error on test rows against hidden nodes, for two, three and four sensors."""
    groups = {
        f"{sensors} sensors": [
            (number(row, "hidden"), number(row, "test mean"))
            for row in rows_of(nodes, sensors=sensors)
        ]
        for sensors in PRINTED
    }
    printed = PRINTED[2][1]
    return Plot(
        "hidden_nodes",
        "Hidden nodes, as in figure 3.13",
        "hidden nodes",
        "mean squared error on test rows",
        groups,
        "Errors of load and position on test rows for two, three and four sensors.",
        ["hidden_nodes"],
        linear="x",
        levels={f"thesis, 2 sensors, 6 nodes: {printed:g}": printed},
    )


def _all_in_order(dropped: Table) -> list[Row]:
    whole = rows_of(dropped, way=EACH, left_out="none")
    return [*whole, *rows_of(dropped, way=IN_ORDER)]


def fewest(dropped: Table) -> tuple[str, ...]:
    """The fewest sensors that suffice.

    They suffice if the worst output has, in at least one split, no larger error than the mean with
    the best set of sensors.
    """
    steps = [row for row in _all_in_order(dropped) if row["output"] == WORST]
    best = min(number(row, "mean %") for row in steps)
    enough = [row for row in steps if number(row, "least %") <= best]
    return tuple(str(min(enough, key=lambda row: number(row, "sensors"))["kept"]).split())


def _of(row: Row, kind: str) -> str:
    whole, lean = (row[f"{kind}, {how}"] for how in (WHOLE, LEAN))
    return UNKNOWN if whole is None else f"{lean:,} of the {whole:,}"


def _saved(row: Row, kind: str) -> list[str]:
    if row[f"{kind}, {WHOLE}"] is None:
        return [UNKNOWN, "", ""]
    whole, lean = (number(row, f"{kind}, {how}") for how in (WHOLE, LEAN))
    part = f" ({100 * (whole - lean) / whole:.0f} %)" if whole != lean else ""
    return [f"{whole:,.0f}", f"{lean:,.0f}", f"{whole - lean:,.0f}{part}"]


def _range(row: Row) -> str:
    mean, least, most = (number(row, f"{name} %") for name in ("mean", "least", "most"))
    return f"{mean:.2f} ({least:.2f} to {most:.2f})"


def _millionths(error: float) -> str:
    return f"{1e6 * error:.0f}"


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"
