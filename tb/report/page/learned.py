"""The tables of networks of learned functions, as the pages show them."""

from collections.abc import Callable, Iterator, Mapping, Sequence

from golden.disturbance import Disturbance
from golden.scene import load_scene
from golden.scene_errors import disturbed_errors, trained_means
from hdl.synth.budget import budget_path, read_budget
from tb.report.measure.bounds import bounds_of
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
# An engine of MLPs, one of learned functions, and what the latter may take. Its errors may be so
# large on held-out rows and, in multiples of the bound, on all rows with noise.
ENGINES = "digit", "comparison/digit-sums"
MOST_OF_ENGINE = {
    "LUTs of four inputs, Virtex-II": 140,
    "multipliers": 1,
    "block RAMs": 2,
    "clocks": 170,
}
MOST_HELD_OUT = dict(zip(OUTPUTS, (0.4, 0.45, 0.4, 0.15), strict=True))
MOST_TIMES, NOISE = 1.5, 0.002
HELD_OUT, AT_NOISE = "held out", "all rows, 2 mV"
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
    lines = _beside(SCENES, MOST)
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


def engines() -> str:
    """Sizes and errors of an engine of MLPs and one of learned functions, and what is missed.

    Errors on held-out rows are those that training measured, without noise and with that of the
    scene; those on all rows at 2 mV are of the shipped networks.
    """
    lines = _beside(ENGINES, MOST_OF_ENGINE)
    first, second = map(_errors, ENGINES)
    bounds = bounds_of(load_scene(ENGINES[0]), [NOISE])
    for (what, output), own in second.items():
        most = MOST_HELD_OUT[output] if what == HELD_OUT else 0.0
        if what == AT_NOISE and output in bounds:
            most = MOST_TIMES * bounds[output][0]
        text = f"**{own:.2f}**" if most and own > most else f"{own:.2f}"
        allowed = f"{most:.2f}" if most else ""
        lines.append(f"| {output}, {what} % | {first[what, output]:.2f} | {allowed} | {text} |")
    return "\n".join(lines)


def _errors(name: str) -> dict[tuple[str, str], float]:
    """The mean errors of a scene in percent, by the rows and the output."""
    scene = load_scene(name)
    kinds = {
        HELD_OUT: trained_means(scene, "test_mean_percent"),
        "held out, 1 mV": trained_means(scene, "test_disturbed_mean_percent"),
        AT_NOISE: disturbed_errors(scene, Disturbance(noise=NOISE)),
    }
    return {
        (what, output): error
        for what, errors in kinds.items()
        for output, error in zip(OUTPUTS, errors or [], strict=True)
    }


def _beside(names: Sequence[str], most: Mapping[str, int]) -> list[str]:
    """The head of a table of two scenes, and the sizes of both."""
    first, second = (_sizes(name) for name in names)
    heads = [f"`{name.rpartition('/')[2]}`" for name in names]
    lines = [f"| | {heads[0]} | at most | {heads[1]} |", "|---|---|---|---|"]
    for what, allowed in most.items():
        own = str(second[what]) if second[what] <= allowed else f"**{second[what]}**"
        lines.append(f"| {what} | {first[what]} | {allowed} | {own} |")
    return lines


def _sizes(name: str) -> dict[str, int]:
    """The sizes of a scene's networks, as ``MOST`` names them."""
    scene = load_scene(name)
    network = scene.twin().core
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
