"""Tables of what ``make synth`` and ``make lean`` recorded, sorted so that a diff can be read.

The shipped scenes share one table a kind. Any other scene has one beside it, in the same format.
"""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from golden.input_error import InputError, MissingFileError
from tactus.core.hold import held
from tactus.core.table import read_csv_file, read_texts, write_csv_file
from tactus.scene import FOLDER

CELLS, TIMING, LEAN = "cells", "timing", "lean"


def table_of(scene: Path, kind: str) -> tuple[Path, str]:
    """The table with the rows of a scene, and the name of the scene in it."""
    path, shipped = scene.resolve(), FOLDER.resolve()
    if path.stem == path.parent.name and path.is_relative_to(shipped):
        return FOLDER / f"{kind}.csv", path.parent.relative_to(shipped).as_posix()
    return scene.with_suffix(f".{kind}.csv"), scene.stem


def is_recorded(scene: Path, kind: str = CELLS) -> bool:
    """Whether a table has rows of a scene."""
    path, name = table_of(scene, kind)
    return path.is_file() and name in read_texts(path, "scene")


def read_rows(scene: Path, kind: str, columns: Mapping[str, Any]) -> list[list[Any]]:
    """The rows of a scene. Each column is named with the type of its cells."""
    path, name = table_of(scene, kind)
    found: list[list[Any]] = []
    if path.is_file():
        read = read_csv_file(path)
        got, expected = ", ".join(read.names), ", ".join(["scene", *columns])
        if got != expected:
            raise InputError(f"{path}: got columns {got}, expected {expected}")
        for line, (owner, *cells) in zip(read.lines, read.rows, strict=True):
            if owner == name:
                try:
                    row = [of(cell) for of, cell in zip(columns.values(), cells, strict=True)]
                except ValueError:
                    raise InputError(f"{path}:{line}: got {cells}, expected numbers") from None
                found.append(row)
    if not found:
        raise MissingFileError(f"{path}: no rows of {name}; RECORD=1 records them")
    return found


def write_rows(scene: Path, kind: str, columns: Iterable[str], rows: Iterable[list[Any]]) -> None:
    """Replace the rows of a scene, and leave those of other scenes as they are."""
    path, name = table_of(scene, kind)
    # Two commands that record two scenes do not lose each other's rows.
    with held([path.parent]):
        others = read_csv_file(path).rows if path.is_file() else ()
        found = [row for row in others if row[0] != name]
        found += [(name, *map(str, row)) for row in rows]
        write_csv_file(path, [["scene", *columns], *sorted(found)])
