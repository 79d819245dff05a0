"""A table of figures, which can be printed and written as CSV and JSON."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tactus.core.table import read_csv_file, write_csv_file

Cell = str | int | float | None
# Of the random choices of the tables in reports and on pages.
SEED = 1


@dataclass(frozen=True)
class Table:
    """One table.

    name: The name of the table and of its CSV.
    columns: The headings with their units.
    rows: Cells of text or numbers, or None if there is no figure.
    note: Says what was measured and how, and what differs from the reference and why.
    """

    name: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    note: str

    def __post_init__(self) -> None:
        for n, row in enumerate(self.rows, start=1):
            if len(row) != len(self.columns):
                raise ValueError(
                    f"table {self.name}: row {n} has {len(row)} cells, expected {len(self.columns)}"
                )
            for heading, cell in zip(self.columns, row, strict=True):
                if isinstance(cell, float) and not math.isfinite(cell):
                    raise ValueError(
                        f"table {self.name}: row {n}, {heading}: got {cell}, expected a finite "
                        "number, or None for no figure"
                    )

    @classmethod
    def of(cls, name: str, rows: Sequence[Row], note: str) -> Table:
        """A table of rows, at least one, by the headings of their cells."""
        return cls(name, list(rows[0]), [list(row.values()) for row in rows], note)

    @property
    def numbers(self) -> list[bool]:
        """Whether each column holds nothing but numbers."""
        return [
            all(not isinstance(row[c], str) for row in self.rows) for c in range(len(self.columns))
        ]

    @property
    def shown(self) -> list[list[str]]:
        """The cells of a page: whole numbers in groups of three digits, and floats rounded.

        The floats of a column have the decimals that give its largest three significant digits. If
        they span a thousand, or stand beside counts, each has its own decimals.
        """
        places = [_decimals(row[c] for row in self.rows) for c in range(len(self.columns))]
        return [list(map(_shown, row, places)) for row in self.rows]

    def as_data(self) -> dict[str, Any]:
        """The table as data for JSON, with all digits."""
        return {
            "columns": list(self.columns),
            "rows": [list(row) for row in self.rows],
            "note": self.note,
        }

    def write_csv(self, path: Path) -> None:
        """Write the columns and rows with all digits. None becomes an empty cell."""
        write_csv_file(path, [self.columns, *self.rows])

    def lines(self) -> list[str]:
        """The table as text: its name, its columns side by side, and its note."""
        text = [list(self.columns), *([cell_text(cell) for cell in row] for row in self.rows)]
        widths = [max(len(row[c]) for row in text) for c in range(len(self.columns))]
        body = [
            "  ".join(
                cell.rjust(width) if right else cell.ljust(width)
                for cell, width, right in zip(row, widths, self.numbers, strict=True)
            ).rstrip()
            for row in text
        ]
        return [self.name, "", *body, "", *textwrap.wrap(self.note, 100, break_on_hyphens=False)]


def read_csv(path: Path) -> tuple[list[str], list[list[Cell]]]:
    """The columns and rows of a CSV that ``Table.write_csv`` wrote."""
    found = read_csv_file(path)
    return list(found.names), [[_cell(cell) for cell in row] for row in found.rows]


def _cell(cell: str) -> Cell:
    """A number, a text, or nothing."""
    if not cell:
        return None
    for kind in (int, float):
        with suppress(ValueError):
            return kind(cell)
    return cell


def _decimals(cells: Iterable[Cell]) -> int | None:
    found = [cell for cell in cells if cell]
    sizes = [abs(cell) for cell in found if isinstance(cell, float)]
    counts = any(isinstance(cell, int) for cell in found)
    if counts or not sizes or max(sizes) >= 1000 * min(sizes):
        return None
    places = max(int(min(sizes) < 10), 2 - math.floor(math.log10(max(sizes))))
    # A part of 1 must not look like 0 or 1.
    while any(size < 1 and round(size, places) in (0, 1) for size in sizes):
        places += 1
    return places


def _shown(cell: Cell, places: int | None) -> str:
    if isinstance(cell, float) and places is not None:
        return f"{cell:,.{places}f}"
    if isinstance(cell, float):
        return f"{cell:,.0f}" if 100 <= abs(cell) < 1e6 else f"{cell:.3g}"
    return f"{cell:,}" if isinstance(cell, int) else cell_text(cell)


def cell_text(cell: Cell) -> str:
    """A cell for a reader, with four significant digits if it is a float."""
    if cell is None:
        return "-"
    return f"{cell:.4g}" if isinstance(cell, float) else str(cell)


def markdown(heads: str, rows: Iterable[Iterable[object]]) -> str:
    """A table of Markdown.

    heads: The headings, with ``" | "`` between them.
    """
    cells = [[str(cell).replace("|", r"\|") for cell in row] for row in rows]
    lines = [heads.split(" | "), ["---"] * len(heads.split(" | ")), *cells]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


Row = dict[str, Cell]
