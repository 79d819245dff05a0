"""Reads and writes CSV files with a header, and says which cell of one is wrong."""

import csv
import io
import math
import re
import shlex
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from hashlib import blake2b
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.input_error import InputError, suggest
from tactus.core.files import check_file, reading, replace_file

# The signs that spreadsheets write between cells instead of a comma.
FOREIGN = {";": "a semicolon", "\t": "a tab", "|": "a bar"}
DECIMAL_COMMA = re.compile(r"\s*[-+]?\d*,\d+([eE][-+]?\d+)?\s*")


@dataclass(frozen=True)
class Column:
    """One column.

    values, shape (rows,): NaN where a cell holds no finite number.
    odd: Line in the file and text of the cells that hold none.
    """

    name: str
    values: NDArray[np.float64]
    odd: tuple[tuple[int, str], ...]

    @property
    def numeric(self) -> bool:
        """Whether the column is meant to hold numbers, which is assumed if half of its cells do."""
        return 2 * len(self.odd) <= len(self.values)

    def fault(self, path: Path) -> str:
        """A message about the first cell that is no number; empty if there is none."""
        if not self.odd:
            return ""
        line, text = self.odd[0]
        got = repr(text) if text.strip() else "an empty cell"
        expected = "a number"
        if as_number(text) is not None:
            expected = "a finite number"
        if DECIMAL_COMMA.fullmatch(text):
            expected = f"{text.strip().replace(',', '.')!r} with a decimal point"
        others = f"; {len(self.odd)} cells of the column are none" if len(self.odd) > 1 else ""
        return f"{path}:{line}: column {self.name!r}: got {got}, expected {expected}{others}"


@dataclass(frozen=True)
class CsvFile:
    """Every cell of a CSV file.

    names: The header, without blanks around the names.
    lines: The line of each row in the file.
    """

    path: Path
    names: tuple[str, ...]
    lines: tuple[int, ...]
    rows: tuple[tuple[str, ...], ...]
    _columns: dict[str, Column] = field(default_factory=dict, repr=False, compare=False)

    def column(self, name: str) -> Column:
        """A column by its name."""
        if name not in self._columns:
            at = self.names.index(name)
            texts = [row[at] for row in self.rows]
            numbers = map(as_number, texts)
            values = np.array([math.nan if number is None else number for number in numbers])
            bad = ~np.isfinite(values)
            values[bad] = np.nan
            odd = tuple((self.lines[r], texts[r]) for r in np.flatnonzero(bad))
            self._columns[name] = Column(name, values, odd)
        return self._columns[name]

    def refuse_numbers(self) -> None:
        """Refuse a first line of numbers."""
        numbers = [as_number(name) for name in self.names]
        if all(number is not None and math.isfinite(number) for number in numbers):
            raise InputError(
                f"{self.path}: the first line holds numbers, expected the names of the columns"
            )


def read_csv_file(path: Path) -> CsvFile:
    """Read a CSV file in UTF-8 with commas, whose first line names the columns."""
    found = _read(path)
    found.refuse_numbers()
    return found


def read_table(path: Path, columns: Sequence[str]) -> NDArray[np.float64]:
    """Read some columns of a CSV file, by their names.

    path: See ``read_csv_file``; a name may be a number.
    columns: Names of the columns, in the order of the result.

    Returns: shape (rows, columns).
    """
    found = _read(path)
    for name in columns:
        _refuse_missing(found, name)
    for wrong in (found.column(name).fault(path) for name in columns):
        if wrong:
            raise InputError(wrong)
    table = [found.column(name).values for name in columns]
    return np.stack(table, axis=1) if table else np.empty((len(found.rows), 0))


def read_texts(path: Path, column: str) -> tuple[str, ...]:
    """Read the texts in a column of a CSV file, without blanks around them."""
    found = _read(path)
    _refuse_missing(found, column)
    at = found.names.index(column)
    texts = tuple(row[at].strip() for row in found.rows)
    for line, text in zip(found.lines, texts, strict=True):
        if not text:
            raise InputError(f"{path}:{line}: column {column!r}: got an empty cell, expected text")
    return texts


def holds_texts(path: Path, column: str) -> bool:
    """Whether a column of a CSV file is meant to hold texts."""
    found = _read(path)
    _refuse_missing(found, column)
    return not found.column(column).numeric


def number_of(text: str) -> float:
    """A number that stands for a text in every file; two texts have the same once in 2**48."""
    return float(int.from_bytes(blake2b(text.encode(), digest_size=6).digest()))


def read_groups(path: Path, columns: Sequence[str]) -> NDArray[np.float64]:
    """Read columns whose rows with the same values are groups; texts are read by ``number_of``.

    Returns: shape (rows, columns).
    """
    found = [
        np.array([[number_of(text)] for text in read_texts(path, name)])
        if holds_texts(path, name)
        else read_table(path, [name])
        for name in columns
    ]
    return np.hstack(found) if found else read_table(path, [])


def _refuse_missing(found: CsvFile, name: str) -> None:
    if name not in found.names:
        found.refuse_numbers()
        known = ", ".join(found.names)
        raise InputError(
            f"{found.path}: no column {name!r}, got {known}{suggest(name, found.names)}"
        )


def _read(path: Path) -> CsvFile:
    check_file(path)
    with reading(path, "CSV"):
        data = path.read_bytes()
    return _parsed(path, data)


# The answer is kept, because the recordings of a scene are read again for other columns.
@lru_cache(maxsize=16)
def _parsed(path: Path, data: bytes) -> CsvFile:
    text = _text(path, data)
    _refuse_separator(path, text)
    reader = csv.reader(io.StringIO(text, newline=""))
    with reading(path, "CSV"):
        rows = [(reader.line_num, tuple(row)) for row in reader if any(map(str.strip, row))]
    if len(rows) < 2:
        raise InputError(f"{path}: got {len(rows)} lines, expected a header and at least one row")
    names = tuple(name.strip() for name in rows[0][1])
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


def rows_where(path: Path, where: Mapping[str, float | str]) -> NDArray[np.intp]:
    """Numbers, from 0, of the rows of a CSV file whose columns have the values in ``where``."""
    kept = np.full(len(_read(path).rows), True)
    for name, value in where.items():
        if isinstance(value, str):
            kept &= np.array(read_texts(path, name)) == value
        elif holds_texts(path, name):
            text = read_texts(path, name)[0]
            raise InputError(
                f"{path}: column {name!r} holds texts such as {text!r}, got {value:g}, expected "
                "one of them"
            )
        else:
            kept &= read_table(path, [name])[:, 0] == value
    if not kept.any():
        wanted = ", ".join(
            f"{n} = {v!r}" if isinstance(v, str) else f"{n} = {v:g}" for n, v in where.items()
        )
        names = [name for name, value in where.items() if isinstance(value, str)]
        near = "".join(suggest(str(where[n]), sorted(set(read_texts(path, n)))) for n in names)
        raise InputError(f"{path}: no row has {wanted}, expected one or more{near}")
    return np.flatnonzero(kept)


def write_csv_file(path: Path, rows: Iterable[Iterable[object]]) -> None:
    """Write the rows of a CSV, the names of its columns first."""
    with replace_file(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as out:
        csv.writer(out, lineterminator="\n").writerows(rows)


def write_table(path: Path, columns: Sequence[str], values: ArrayLike, decimals: int) -> None:
    """Write a CSV file for ``read_table``, with a fixed number of decimals.

    values: shape (rows, columns).
    decimals: Four are enough for a code of Fix(14,13), since rounding then moves a value by less
        than half an LSB.
    """
    array = np.asarray(values, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != len(columns):
        raise InputError(f"{path}: got shape {array.shape}, expected (rows, {len(columns)})")
    if not np.isfinite(array).all():
        raise InputError(f"{path}: got {array[~np.isfinite(array)][0]}, expected finite numbers")
    # Adding 0 turns -0 into 0.
    lines = (",".join(f"{cell:.{decimals}f}" for cell in row) for row in array.round(decimals) + 0)
    with replace_file(path) as temporary:
        temporary.write_text("\n".join([",".join(columns), *lines, ""]), encoding="utf-8")


def _text(path: Path, data: bytes) -> str:
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
    """Refuse a table whose cells are separated by another sign than a comma."""
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


def as_number(text: str) -> float | None:
    """The number in a cell, finite or not."""
    try:
        # Python also accepts 1_0 and digits of other scripts, which are more likely mistakes here.
        return float(text if text.isascii() and "_" not in text else "")
    except ValueError:
        return None
