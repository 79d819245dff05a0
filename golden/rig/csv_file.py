"""A user's CSV file, read as text so that messages can say exactly what is wrong with it."""

from __future__ import annotations

import csv
import io
import re
import shlex
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from golden.files import check_file, reading
from golden.input_error import InputError

# Other separators that spreadsheets write between cells.
FOREIGN = {";": "a semicolon", "\t": "a tab", "|": "a bar"}
DECIMAL_COMMA = re.compile(r"\s*[-+]?\d*,\d+([eE][-+]?\d+)?\s*")


@dataclass(frozen=True)
class Column:
    """One column of a CSV file.

    Attributes
    ----------
    name : str
    values : float array, shape (rows,)
        NaN where a cell holds no finite number.
    odd : tuple of (int, str)
        Line number and text of each cell that holds no finite number.
    """

    name: str
    values: NDArray[np.float64]
    odd: tuple[tuple[int, str], ...]

    @property
    def numeric(self) -> bool:
        """Whether the column is meant to hold numbers: at least half of its cells do."""
        return 2 * len(self.odd) <= len(self.values)

    def fault(self, path: Path) -> str:
        """The fault of a column of numbers, as a message; empty if there is none."""
        if not self.odd:
            return ""
        line, text = self.odd[0]
        got = repr(text) if text.strip() else "an empty cell"
        expected = "a number"
        if DECIMAL_COMMA.fullmatch(text):
            expected = f"{text.strip().replace(',', '.')!r} with a decimal point"
        others = f"; {len(self.odd)} cells of the column are none" if len(self.odd) > 1 else ""
        return f"{path}:{line}: column {self.name!r}: got {got}, expected {expected}{others}"


@dataclass(frozen=True)
class CsvFile:
    """All cells of a CSV file.

    Attributes
    ----------
    path : Path
    names : tuple of str
        The names in the header, without blanks around them.
    lines : tuple of int
        Line number of each row in the file.
    rows : tuple of tuple of str
    """

    path: Path
    names: tuple[str, ...]
    lines: tuple[int, ...]
    rows: tuple[tuple[str, ...], ...]

    def column(self, name: str) -> Column:
        """Find a column by its name."""
        at = self.names.index(name)
        texts = [row[at] for row in self.rows]
        values = np.array([_number(text) for text in texts])
        bad = ~np.isfinite(values)
        values[bad] = np.nan
        odd = tuple((self.lines[r], texts[r]) for r in np.flatnonzero(bad))
        return Column(name, values, odd)


def read_csv_file(path: Path) -> CsvFile:
    """Read a CSV file in UTF-8 with commas, whose first line holds the names of the columns.

    Raises
    ------
    InputError
        When there is no such file, or it cannot be read. Also for text that is not UTF-8, another
        separator than a comma, no rows, a header of numbers, a name that stands twice, or rows of
        another length than the header.
    """
    check_file(path)
    text = _text(path)
    _refuse_separator(path, text)
    reader = csv.reader(io.StringIO(text, newline=""))
    with reading(path, "CSV"):
        rows = [(reader.line_num, tuple(row)) for row in reader if any(map(str.strip, row))]
    if len(rows) < 2:
        raise InputError(f"{path}: got {len(rows)} lines, expected a header and at least one row")
    names = tuple(name.strip() for name in rows[0][1])
    if all(np.isfinite(_number(name)) for name in names):
        raise InputError(f"{path}: the first line holds numbers, expected the names of the columns")
    for name in names:
        if name and names.count(name) > 1:
            raise InputError(f"{path}: column {name!r} stands twice in the header")
    for line, row in rows[1:]:
        if len(row) != len(names):
            hint = ""
            if len(row) == 2 * len(names):
                hint = "; is that a decimal comma? expected a decimal point, 0.5 and not 0,5"
            raise InputError(f"{path}:{line}: got {len(row)} cells, expected {len(names)}{hint}")
    return CsvFile(
        path, names, tuple(line for line, _ in rows[1:]), tuple(row for _, row in rows[1:])
    )


def _text(path: Path) -> str:
    with reading(path, "CSV"):
        data = path.read_bytes()
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise InputError(f"{path}: got UTF-16, expected UTF-8; save it as 'CSV UTF-8'")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise InputError(
            f"{path}:{line}: got byte 0x{data[error.start]:02x}, expected UTF-8; save it as "
            "'CSV UTF-8'"
        ) from None


def _refuse_separator(path: Path, text: str) -> None:
    """Refuse a header of one cell that contains another sign, which must be the separator."""
    header = next((line for line in text.splitlines() if line.strip()), "")
    if len(next(csv.reader([header]), [])) > 1:
        return
    for sign, name in FOREIGN.items():
        if sign in header:
            below = text.partition(header)[2]
            decimal = "," in below
            got = f"{name} between the cells" + (" and decimal commas" if decimal else "")
            change, into = (f"{sign},", ",.") if decimal else (sign, ",")
            shown = change.replace("\t", "\\t")
            raise InputError(
                f"{path}: got {got}, expected a comma{' and decimal points' if decimal else ''}; "
                f"tr '{shown}' '{into}' < {shlex.quote(str(path))} > comma.csv converts it"
            )
    words = header.split()
    if len(words) > 1 and any(len(line.split()) == len(words) for line in text.splitlines()[1:2]):
        raise InputError(f"{path}: got blanks between the cells, expected a comma")


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return float("nan")
