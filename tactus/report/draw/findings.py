"""The rows of tables by the names of their columns, for plots and sentences."""

from collections.abc import Callable

from tactus.report.measure.table import Cell, Table

Row = dict[str, Cell]


def rows_of(table: Table, **where: Cell) -> list[Row]:
    """The rows that have the values of ``where``, as mappings. ``_`` stands for a blank."""
    wanted = {key.replace("_", " "): value for key, value in where.items()}
    rows = [dict(zip(table.columns, row, strict=True)) for row in table.rows]
    unknown = wanted.keys() - set(table.columns)
    found = [row for row in rows if all(row[key] == value for key, value in wanted.items())]
    if unknown or not found:
        raise ValueError(f"table {table.name}: no row with {wanted}, columns {table.columns}")
    return found


def number(row: Row, column: str) -> float:
    """A cell that must hold a number."""
    value = row[column]
    if not isinstance(value, int | float):
        raise ValueError(f"column {column}: got {value!r}, expected a number")
    return float(value)


def groups(
    rows: list[Row], label: Callable[[Row], str], x: str, y: str
) -> dict[str, list[tuple[float, float]]]:
    """The points (x, y) by label. Rows without x or y are left out."""
    found: dict[str, list[tuple[float, float]]] = {}
    for row in rows:
        if row[x] is not None and row[y] is not None:
            found.setdefault(label(row), []).append((number(row, x), number(row, y)))
    return found
