"""The budget: the recorded cells of a scene's entities. New counts are compared with it."""

from pathlib import Path
from typing import Any

from golden.common.block import walk
from golden.networks.network import Network
from tactus.scene import Scene, thesis_table
from tactus.synth.cells import DEPTH
from tactus.synth.netlist import KINDS
from tactus.synth.recorded import CELLS, read_rows, write_rows

COLUMNS = ["family", "entity", *KINDS, DEPTH]
# Counts by family, by entity, and by the kind of cell.
Cells = dict[str, dict[str, dict[str, int]]]


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
    """A row for each entity of each family."""
    return [
        [family, entity, *(entities[entity][name] for name in COLUMNS[2:])]
        for family, entities in found.items()
        for entity in sorted(entities)
    ]


def write_budget(scene: Path, found: Cells) -> None:
    """Record the cells that were found for a scene."""
    write_rows(scene, CELLS, COLUMNS, rows(found))


def read_budget(scene: Path) -> Cells:
    """The recorded cells of a scene."""
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
