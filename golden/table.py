"""Recorded vectors: a CSV file of numbers with a header, checked cell by cell."""

from __future__ import annotations

import csv
import difflib
import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.files import check_file, reading, replace_file
from golden.input_error import InputError


def read_table(path: Path, columns: Sequence[str]) -> NDArray[np.float64]:
    """Read some columns of a CSV file, by their names.

    Parameters
    ----------
    path : Path
        A file in UTF-8, separated by commas, whose first line holds the names of the columns.
    columns : sequence of str
        Names of the columns, in the order of the result.

    Returns
    -------
    float array, shape (rows, columns)

    Raises
    ------
    InputError
        When there is no such file, or when it cannot be read. For an empty file, a missing or
        repeated column, a row of another length than the header, or a cell that is no number, NaN
        or infinity; the message names file, line and column.
    """
    check_file(path)
    with reading(path, "CSV"), path.open(newline="", encoding="utf-8-sig") as handle:
        rows = [(reader.line_num, row) for reader in [csv.reader(handle)] for row in reader if row]
    if len(rows) < 2:
        raise InputError(f"{path}: got {len(rows)} lines, expected a header and at least one row")
    header = [name.strip() for name in rows[0][1]]
    repeated = sorted({name for name in header if header.count(name) > 1})
    if repeated:
        raise InputError(f"{path}: column {repeated[0]!r} stands twice in the header")
    for name in columns:
        if name not in header:
            raise InputError(
                f"{path}: no column {name!r}, got {', '.join(header)}{suggest(name, header)}"
            )
    where = [header.index(name) for name in columns]
    values = np.empty((len(rows) - 1, len(columns)))
    for r, (line, row) in enumerate(rows[1:]):
        if len(row) != len(header):
            raise InputError(f"{path}:{line}: got {len(row)} cells, expected {len(header)}")
        for c, at in enumerate(where):
            values[r, c] = _number(row[at], f"{path}:{line}: column {columns[c]!r}")
    return values


def rows_where(path: Path, where: Mapping[str, float]) -> NDArray[np.intp]:
    """Numbers, from 0, of the rows of a CSV file whose columns have the values in ``where``.

    Raises
    ------
    InputError
        See ``read_table``. Also when there is no such row.
    """
    columns = list(where)
    kept = (read_table(path, columns) == list(where.values())).all(axis=1)
    if not kept.any():
        wanted = ", ".join(f"{name} = {value:g}" for name, value in where.items())
        raise InputError(f"{path}: no row has {wanted}, expected one or more")
    return np.flatnonzero(kept)


def write_table(path: Path, columns: Sequence[str], values: ArrayLike, decimals: int) -> None:
    """Write a CSV file for ``read_table``, with a fixed number of decimals.

    Parameters
    ----------
    path : Path
    columns : sequence of str
    values : array_like of float, shape (rows, columns)
    decimals : int
        Four are enough for a code of Fix(14,13), since rounding then moves a value by less than
        half an LSB.

    Raises
    ------
    InputError
        For values of another shape, NaN or infinity.
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


def _number(text: str, place: str) -> float:
    try:
        # Python also accepts 1_0 and digits of other scripts, which are more likely mistakes here.
        value = float(text if text.isascii() and "_" not in text else "")
    except ValueError:
        raise InputError(f"{place}: got {text!r}, expected a number") from None
    if not math.isfinite(value):
        raise InputError(f"{place}: got {text.strip()}, expected a finite number")
    return value


def suggest(name: str, known: Sequence[str]) -> str:
    """A hint that names the nearest known name; empty if none is near."""
    near = difflib.get_close_matches(name, known, n=1)
    return f"; did you mean {near[0]!r}?" if near else ""
