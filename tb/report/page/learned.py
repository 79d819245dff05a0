"""The tables of networks of learned functions, as the pages show them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from golden.scene import load_scene
from hdl.synth.budget import budget_path, read_budget
from tb.report.measure.table import Cell, Table
from tb.report.measure.table_graphs import SCENES

Row = Mapping[str, Cell]
OUTPUTS = ("load", "position", "width", "shape")
# What a frame a clock of learned functions may take: see ``small_tables``.
MOST = {
    "LUTs, Series 7": 1200,
    "LUTs of four inputs, Virtex-II": 2400,
    "multipliers": 0,
    "block RAMs": 0,
    "clocks": 6,
}
SPLITS = ("held out 1 %", "held out 2 %", "held out 3 %")


def first_split(table: Table) -> str:
    """The errors on the held-out rows of the split of the scene."""
    return _lines(table, lambda row: _figure(row[SPLITS[0]]), sizes=True)


def all_splits(table: Table) -> str:
    """The ranges of the errors over all splits."""
    return _lines(table, _range, shipped=False)


def disturbed(table: Table) -> str:
    """The mean errors on held-out rows under noise and under drift."""

    def text(row: Row) -> str:
        parts = [_figure(row[name]) for name in ("held out, 2 mV %", "held out, drift %")]
        return ", ".join(parts)

    return _lines(table, text, shipped=False)


def noisy(table: Table) -> str:
    """The errors at 2 mV on all rows, with the multiple of the bound where there is one."""

    def text(row: Row) -> str:
        error, bound = row["all rows, 2 mV %"], row["bound %"]
        assert isinstance(error, float)
        times = f" ({error / bound:.2f})" if isinstance(bound, float) else ""
        return f"{error:.2f}{times}"

    return _lines(table, text)


def segments(table: Table) -> str:
    """The errors of cascades with narrower and narrower segments."""
    heads = [*table.columns[:4], *OUTPUTS]
    lines = [f"| {' | '.join(heads)} |", f"|{'---|' * len(heads)}"]
    kinds: dict[tuple[Cell, ...], list[str]] = {}
    for *first, _, held_out, every in table.rows:
        kinds.setdefault(tuple(first), []).append(f"{held_out:.2f}, {every:.2f}")
    for sizes, cells in kinds.items():
        texts = ("" if size is None else str(size) for size in sizes)
        lines.append(f"| {' | '.join([*texts, *cells])} |")
    return "\n".join(lines)


def classes(table: Table) -> str:
    """Parameters, edges and wrong decisions of networks for classes."""
    heads = ["scene", "network", "candidates", "parameters", "curved", "straight", "held-out rows"]
    heads += ["wrong in each split", "wrong %", "in tables %"]
    lines = [f"| {' | '.join(heads)} |", f"|{'---|' * len(heads)}"]
    for cells in table.rows:
        row = dict(zip(table.columns, cells, strict=True))
        counts = [str(row[name]) for name in table.columns if name.startswith("wrong ")][:-1]
        # Not every scene has as many splits.
        in_splits = ", ".join(count for count in counts if count != "None")
        in_tables = "" if row["in tables %"] is None else _figure(row["in tables %"])
        first = [f"`{row['scene']}`", *(str(row[name]) for name in heads[1:7])]
        lines.append(f"| {' | '.join([*first, in_splits, _figure(row['wrong %']), in_tables])} |")
    return "\n".join(lines)


def elsewhere(scene: str, table: Table) -> str:
    """The sizes of a scene's networks, and ranges and means of their errors over all splits."""
    found: dict[Cell, dict[str, Row]] = {}
    for cells in table.rows:
        row = dict(zip(table.columns, cells, strict=True))
        if row["scene"] == scene:
            found.setdefault(row["network"], {})[str(row["output"])] = row
    sizes = ("network", "candidates", "parameters", "steps")
    heads = [*sizes, *next(iter(found.values()))]
    lines = [f"| {' | '.join(heads)} |", f"|{'---|' * len(heads)}"]
    for outputs in found.values():
        first = next(iter(outputs.values()))
        errors = (f"{_range(row)} ({_figure(row['mean %'])})" for row in outputs.values())
        line = [*(str(first[name]) for name in sizes), *errors]
        lines.append(f"| {' | '.join(line)} |")
    return "\n".join(lines)


def small_tables(table: Table) -> str:
    """Sizes and held-out errors of a graph of tanh and one of small tables, and what is missed."""
    first, second = map(_sizes, SCENES)
    names = [f"`{name.rpartition('/')[2]}`" for name in SCENES]
    lines = [f"| | {names[0]} | at most | {names[1]} |", "|---|---|---|---|"]
    for what, most in MOST.items():
        found = str(second[what])
        cells = [
            what,
            str(first[what]),
            str(most),
            found if second[what] <= most else f"**{found}**",
        ]
        lines.append(f"| {' | '.join(cells)} |")
    figures = {(row[0], row[1]): row[2:] for row in table.rows}
    for place, kind in enumerate(table.columns[2:]):
        for output in OUTPUTS:
            own, other = (figures[name, output][place] for name in SCENES[::-1])
            assert isinstance(own, float)
            assert isinstance(other, float)
            bound = "" if kind == "float %" else f"{other:.2f}"
            text = f"**{own:.2f}**" if bound and own > other else f"{own:.2f}"
            lines.append(f"| {output}, {kind} | {other:.2f} | {bound} | {text} |")
    return "\n".join(lines)


def _sizes(name: str) -> dict[str, int]:
    """The sizes of a scene's networks, as ``MOST`` names them."""
    scene = load_scene(name)
    network = scene.twin()
    small, large = (
        read_budget(budget_path(scene.path))[f][network.entity] for f in ("xc7", "xc2v")
    )
    counts = [small["LUT"], large["LUT"], large["multiplier"], large["block RAM"]]
    return dict(zip(MOST, [*counts, network.output_clocks[-1]], strict=True))


def _lines(
    table: Table, text: Callable[[Row], str], shipped: bool = True, sizes: bool = False
) -> str:
    heads = ["arrangement", "network", *(["parameters", "steps"] if sizes else []), *OUTPUTS]
    lines = [f"| {' | '.join(heads)} |", f"|{'---|' * len(heads)}"]
    for first, outputs in _networks(table):
        if shipped or first["network"] != "shipped":
            size = [str(first["parameters"]), str(first["steps"])] if sizes else []
            cells = [str(first["arrangement"]), str(first["network"]), *size]
            lines.append(f"| {' | '.join([*cells, *(text(outputs[o]) for o in OUTPUTS)])} |")
    return "\n".join(lines)


def _networks(table: Table) -> Iterator[tuple[Row, dict[str, Row]]]:
    """The rows of each network, by output, with the first of them."""
    found: dict[tuple[Cell, Cell], dict[str, Row]] = {}
    for cells in table.rows:
        row = dict(zip(table.columns, cells, strict=True))
        found.setdefault((row["arrangement"], row["network"]), {})[str(row["output"])] = row
    for outputs in found.values():
        yield next(iter(outputs.values())), outputs


def _figure(cell: Cell) -> str:
    assert isinstance(cell, float)
    return f"{cell:.2f}"


def _range(row: Row) -> str:
    found = [cell for cell in map(row.get, SPLITS) if isinstance(cell, float)]
    return f"{min(found):.2f} to {max(found):.2f}"
