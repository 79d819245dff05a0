"""A table of figures, which can be printed and written as CSV and JSON."""

from __future__ import annotations

import argparse
import csv
import math
import textwrap
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tactus.core.files import replace_file
from tactus.core.table import read_csv_file

Cell = str | int | float | None


@dataclass(frozen=True)
class Table:
    """One table.

    name: The name of the table and of its CSV.
    columns: The headings with their units.
    rows: Cells of text or numbers, or None if there is no figure.
    note: Says what was measured and how, and what differs from the reference and why.
    timed: The columns that hold run times of this machine, which differ from call to call.
    """

    name: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    note: str
    timed: Sequence[str] = ()

    def __post_init__(self) -> None:
        for heading in self.timed:
            if heading not in self.columns:
                raise ValueError(
                    f"table {self.name}: timed: got {heading!r}, expected one of "
                    f"{', '.join(self.columns)}"
                )
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

    @property
    def numbers(self) -> list[bool]:
        """Whether each column holds nothing but numbers."""
        return [
            all(not isinstance(row[c], str) for row in self.rows) for c in range(len(self.columns))
        ]

    def without_times(self) -> Table:
        """The table without its timed columns, which is the same again for the same seed."""
        kept = [c for c, heading in enumerate(self.columns) if heading not in self.timed]
        return Table(
            self.name,
            [self.columns[c] for c in kept],
            [[row[c] for c in kept] for row in self.rows],
            self.note,
        )

    def as_data(self) -> dict[str, Any]:
        """The table as data for JSON, with all digits."""
        return {
            "columns": list(self.columns),
            "rows": [list(row) for row in self.rows],
            "note": self.note,
        }

    def write_csv(self, path: Path) -> None:
        """Write the columns and rows with all digits. None becomes an empty cell."""
        with path.open("w", newline="", encoding="utf-8") as handle:
            writer = csv.writer(handle, lineterminator="\n")
            writer.writerow(self.columns)
            writer.writerows(self.rows)

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
        return [self.name, "", *body, "", *textwrap.wrap(self.note, 100)]


def read_csv(path: Path) -> tuple[list[str], list[list[Cell]]]:
    """The columns and rows of a CSV that ``Table.write_csv`` wrote."""
    found = read_csv_file(path)
    return list(found.names), [[_cell(cell) for cell in row] for row in found.rows]


def print_or_record(
    prog: str, about: str | None, record: Path, measured: Callable[[], Table]
) -> None:
    """The command of a table that takes long: it prints the table, and records it with --record."""
    parser = argparse.ArgumentParser(prog=prog, description=about)
    parser.add_argument("--record", action="store_true")
    arguments = parser.parse_args()
    table = measured()
    print("\n".join(table.lines()))
    if arguments.record:
        with replace_file(record) as temporary:
            table.write_csv(temporary)
        print(f"wrote {record}")


def _cell(cell: str) -> Cell:
    """A number, a text, or nothing."""
    if not cell:
        return None
    for kind in (int, float):
        with suppress(ValueError):
            return kind(cell)
    return cell


def cell_text(cell: Cell) -> str:
    """A cell for a reader, with four significant digits if it is a float."""
    if cell is None:
        return "-"
    return f"{cell:.4g}" if isinstance(cell, float) else str(cell)
