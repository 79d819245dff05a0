"""The tables of networks of learned functions, as the pages show them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from tb.report.measure.table import Cell, Table

Row = Mapping[str, Cell]
OUTPUTS = ("load", "position", "width", "shape")
SPLITS = ("held out 1 %", "held out 2 %", "held out 3 %")


def first_split(table: Table) -> str:
    """The errors on the held-out rows of the split of the scene."""
    return _lines(table, lambda row: _figure(row[SPLITS[0]]), sizes=True)


def all_splits(table: Table) -> str:
    """The ranges of the errors over all splits."""

    def text(row: Row) -> str:
        found = [cell for cell in map(row.get, SPLITS) if isinstance(cell, float)]
        return f"{min(found):.2f} to {max(found):.2f}"

    return _lines(table, text, shipped=False)


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
    """The errors of one cascade with narrower and narrower segments."""
    heads = ["segment width", "words", *OUTPUTS]
    lines = [f"| {' | '.join(heads)} |", f"|{'---|' * len(heads)}"]
    kinds: dict[tuple[Cell, Cell], list[str]] = {}
    for name, words, _, held_out, every in table.rows:
        kinds.setdefault((name, words), []).append(f"{held_out:.2f}, {every:.2f}")
    for (name, words), cells in kinds.items():
        lines.append(f"| {name} | {words or ''} | {' | '.join(cells)} |")
    return "\n".join(lines)


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
