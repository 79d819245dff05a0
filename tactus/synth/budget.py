"""What ``make synth`` recorded, in tables that are sorted so that a diff is read.

The shipped scenes share one table a kind. Any other scene has one beside it, in the same format.
The recorded cells of a scene's entities are its budget, with which new counts are compared.
"""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from golden.common.block import walk
from golden.input_error import InputError, MissingFileError
from golden.networks.network import Network
from tactus.core.hold import held
from tactus.core.table import read_csv_file, read_texts, write_csv_file
from tactus.scene import FOLDER, Scene, thesis_table
from tactus.synth.cells import KINDS

CELLS, TIMING = "cells", "timing"
COLUMNS = ["family", "entity", *KINDS]
# Counts by family, by entity, and by the kind of cell.
Cells = dict[str, dict[str, dict[str, int]]]


def table_of(scene: Path, kind: str) -> tuple[Path, str]:
    """The table with the rows of a scene, and the name of the scene in it."""
    path, shipped = scene.resolve(), FOLDER.resolve()
    if path.stem == path.parent.name and path.is_relative_to(shipped):
        return FOLDER / f"{kind}.csv", path.parent.relative_to(shipped).as_posix()
    return scene.with_suffix(f".{kind}.csv"), scene.stem


def is_recorded(scene: Path, kind: str = CELLS) -> bool:
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


def by_block(design: Network, cells: Cells, family: str) -> list[tuple[str, int, dict[str, int]]]:
    """For each block: the entity with the most LUTs, the number of entities, and its cells."""
    found: dict[str, list[str]] = {}
    for part in walk(design):
        found.setdefault(part.block, []).append(part.entity)
    lines = []
    for names in found.values():
        largest = max(names, key=lambda name: cells[family][name]["LUT"])
        lines.append((largest, len(names), cells[family][largest]))
    return lines


def rows(found: Cells) -> list[list[Any]]:
    return [
        [family, entity, *(entities[entity][name] for name in COLUMNS[2:])]
        for family, entities in found.items()
        for entity in sorted(entities)
    ]


def write_budget(scene: Path, found: Cells) -> None:
    write_rows(scene, CELLS, COLUMNS, rows(found))


def read_budget(scene: Path) -> Cells:
    columns = {"family": str, "entity": str} | dict.fromkeys(COLUMNS[2:], int)
    found: Cells = {}
    for family, entity, *cells in read_rows(scene, CELLS, columns):
        found.setdefault(family, {})[entity] = dict(zip(COLUMNS[2:], cells, strict=True))
    return found


def differences(found: Cells, recorded: Cells) -> list[str]:
    """A line for each figure that is not the recorded one; a lower one counts, too."""
    lines = []
    for family, entities in found.items():
        before = recorded.get(family, {})
        for entity in sorted(entities.keys() | before.keys()):
            got, expected = entities.get(entity), before.get(entity)
            if got is None or expected is None:
                state = "recorded, but not in the design" if got is None else "not recorded"
                lines.append(f"{family}, {entity}: {state}")
                continue
            lines += [
                f"{family}, {entity}: {name}: got {got[name]}, recorded {expected[name]}"
                for name in got
                if got[name] != expected[name]
            ]
    return lines


# The networks of Table 6.1. Other scenes name their table themselves, for the errors, too.
SWING = {
    f"swing-{kind}{form}": f"swing.{kind}"
    for kind in ("single", "multiple", "cascade")
    for form in ("", "-thesis")
}


def shares(scene: Scene, design: Network, cells: Cells) -> dict[str, Any]:
    """Percentages of the thesis' device, and the printed percentages where there are any."""
    device = thesis_table("device")
    top = cells["xc2v"][design.entity]
    found = {
        "device": device["name"],
        "luts_percent": 100 * top["LUT"] / device["luts4"],
        "mult18x18_percent": 100 * top["multiplier"] / device["mult18x18"],
    }
    key = SWING.get(scene.name, scene.reference)
    if key:
        printed = thesis_table(key)
        found["thesis"] = {"table": key} | {
            name: printed[name] for name in ("luts_percent", "mult18x18_percent") if name in printed
        }
    return found
