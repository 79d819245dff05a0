"""A CSV file that grows by rows and holds only whole rows at any time."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Sequence
from pathlib import Path

from golden.input_error import InputError
from tactus.core.files import check_folder, check_writable, writing


class GrowingCsv:
    """A new file to which whole rows are appended.

    A program that reads it meanwhile, or after a power cut, finds whole rows. If the disk becomes
    full within a row, the part that was written is removed again.

    columns: The header.
    """

    def __init__(self, path: Path, columns: Sequence[str]) -> None:
        # The header is not counted.
        self.path, self.rows = path, -1
        for name in columns:
            if columns.count(name) > 1:
                raise InputError(f"{path}: column {name!r} would stand twice; rename it")
        refuse_there(path)
        check_writable([path])
        with writing(path):
            flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_APPEND
            self._file = os.open(path, flags, 0o666)
        self._end = 0
        self.append([columns])

    def __enter__(self) -> GrowingCsv:
        return self

    def __exit__(self, *error: object) -> None:
        os.close(self._file)

    def append(self, rows: Sequence[Sequence[object]]) -> None:
        text = io.StringIO(newline="")
        csv.writer(text, lineterminator="\n").writerows(rows)
        data = text.getvalue().encode()
        written = 0
        try:
            with writing(self.path):
                while written < len(data):
                    written += os.write(self._file, data[written:])
        except InputError:
            os.ftruncate(self._file, self._end)
            raise
        self._end += len(data)
        self.rows += len(rows)


def refuse_there(path: Path) -> None:
    """Refuse to write over a file, or into a folder that is missing."""
    check_folder(path)
    if path.exists() or path.is_symlink():
        raise InputError(f"{path}: is there already; choose another name with TO=")
