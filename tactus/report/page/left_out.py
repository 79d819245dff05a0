"""The content of docs/left-out.md and its tables: lean scenes, and sensors without need."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from golden.activation.left_out import COMPARATORS
from golden.activation.left_out import left_out as left_out_of
from golden.networks.engine import Engine
from golden.networks.oracle import designs_in, exact_layers
from golden.numbers.real import Real
from tactus.report.draw.findings import Row, number, rows_of
from tactus.report.draw.plots import Plot
from tactus.report.measure.clocks import clocks_per_frame
from tactus.report.measure.left_out import LEAN, WHOLE, words
from tactus.report.measure.sensors_dropped import EACH, IN_ORDER, PRINTED
from tactus.report.measure.sensors_shipped import SCENE, SETS, WORST
from tactus.report.measure.table import Table
from tactus.scene import load_scene

CELLS = {"LUT": "LUTs", "flip-flop": "flip-flops", "multiplier": "multipliers"}
UNKNOWN = "not recorded"
# The networks of the default scene in the thesis' form, and one with the first output alone.
FORM, ONE_OUTPUT = "digit-thesis", "digit-load"
PRUNED = (0.1, 0.25, 0.5)


def headline(scenes: Table, shipped: Table) -> str:
    """What leaving out saves in the thesis' form and in a program, and how many sensors suffice."""
    (row,) = rows_of(scenes, scene=FORM)
    every, one = (load_scene(name).twin() for name in (SCENE, ONE_OUTPUT))
    rom = [f"{number(row, f'words, {how}'):,.0f}" for how in (LEAN, WHOLE)]
    worst = {str(r["kept"]): r for r in rows_of(shipped, output=WORST)}
    four, two = (worst[" ".join(sensors)] for sensors in (SETS[0], SETS[-1]))
    return (
        f"**Built as in the thesis, `{FORM}` takes {_of(row, 'LUT')} LUTs and {rom[0]} of {rom[1]} "
        f"words of ROM, and leaves out\n{comparators_left_out(FORM)} comparators. Asked for the "
        f"load alone, `{SCENE}` takes {clocks_per_frame(one)} of {clocks_per_frame(every)} clocks. "
        f"Of known loads, two of the four\nsensors tell as much: the worst output errs by "
        f"{_range(two)} % of its scale, with all four by {_range(four)} %.**"
    )


def kept(scenes: Table) -> dict[str, tuple[float, float]]:
    """How much of the whole is built, by kind: the counts of ``headline``, for a picture."""
    (row,) = rows_of(scenes, scene=FORM)
    one, every = (clocks_per_frame(load_scene(name).twin()) for name in (ONE_OUTPUT, SCENE))
    return {
        "LUTs": (number(row, f"LUT, {LEAN}"), number(row, f"LUT, {WHOLE}")),
        "clocks for load": (one, every),
        "sensors": (len(SETS[-1]), len(SETS[0])),
    }


def comparators_left_out(name: str) -> int:
    """How many comparators of segments that no neuron reaches the hardware of a scene lacks."""
    layers = map(exact_layers, designs_in(load_scene(name).twin()))
    return sum(left_out_of(one)[COMPARATORS] for layer in layers for one in layer.activations)


def program_rows() -> str:
    """Words and clocks of the program of the default scene, and of programs that need less."""
    scene = load_scene(SCENE)
    networks = scene.mlps()
    asked = [", ".join(scene.outputs[:count]) for count in range(len(networks), 0, -1)]
    programs = {f"{names} asked for": networks[: names.count(",") + 1] for names in asked}
    for part in PRUNED:
        programs[f"the least {part:.0%} of the weights of each layer are 0"] = [
            replace(one, w1=_pruned(one.w1, part), w2=_pruned(one.w2, part)) for one in networks
        ]
    programs["a node of each network is dead: no output reads it"] = [
        replace(one, w2=np.where(np.arange(one.w2.shape[1]) == 0, 0.0, one.w2)) for one in networks
    ]
    lines = [_row(["scene `digit` with", "words", "clocks"]), "|---|---|---|"]
    for name, these in programs.items():
        engine = Engine.of(these, scene.settings(True, these), scene.arrangement)
        lines.append(_row([name, str(words(engine)), str(clocks_per_frame(engine))]))
    return "\n".join(lines)


def _pruned(weights: Real, part: float) -> Real:
    return np.where(np.abs(weights) < np.quantile(np.abs(weights), part), 0.0, weights)


def shipped_rows(shipped: Table) -> str:
    """The held-out errors of networks that are trained as the shipped ones, by sensors."""
    outputs = list(dict.fromkeys(str(row["output"]) for row in rows_of(shipped)))
    lines = [_row(["sensors", *(f"{name}, %" for name in outputs)])]
    lines.append(f"|{'---|' * (1 + len(outputs))}")
    for sensors in SETS:
        found = {str(row["output"]): row for row in rows_of(shipped, kept=" ".join(sensors))}
        lines.append(_row([" ".join(sensors), *(_range(found[name]) for name in outputs)]))
    return "\n".join(lines)


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


def sensors_plot(shipped: Table) -> Plot:
    """The error of each output against the number of sensors."""
    groups: dict[str, list[tuple[float, float]]] = {}
    for row in rows_of(shipped):
        point = float(len(str(row["kept"]).split())), number(row, "mean %")
        groups.setdefault(str(row["output"]), []).append(point)
    worst = dict(groups.pop(WORST))
    told = ", ".join(f"{count:g}: {worst[count]:.2g} %" for count in sorted(worst, reverse=True))
    return Plot(
        "sensors_shipped",
        "Fewer sensors, trained as shipped",
        "sensors",
        "mean error on held-out rows, %",
        groups,
        f"The worst output by number of sensors: {told}.",
        ["sensors_shipped"],
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
