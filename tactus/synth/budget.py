"""The budget: the recorded cells of a scene's entities. New counts are compared with it."""

from pathlib import Path

from golden.common.block import walk
from golden.input_error import InputError
from golden.networks.network import Network
from tactus.core.table import read_csv_file, write_csv_file
from tactus.synth.cells import DEPTH
from tactus.synth.netlist import KINDS

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


def budget_path(scene: Path) -> Path:
    """Where the budget of a scene stands: beside it."""
    return scene.with_suffix(".budget.csv")


def write_budget(path: Path, found: Cells) -> None:
    """Record the cells that were found."""
    rows = [
        [family, entity, *(entities[entity][name] for name in COLUMNS[2:])]
        for family, entities in found.items()
        for entity in sorted(entities)
    ]
    write_csv_file(path, [COLUMNS, *rows])


def read_budget(path: Path) -> Cells:
    """The recorded cells."""
    read = read_csv_file(path)
    if list(read.names) != COLUMNS:
        raise InputError(
            f"{path}: got columns {', '.join(read.names)}, expected {', '.join(COLUMNS)}"
        )
    found: Cells = {}
    for line, (family, entity, *cells) in zip(read.lines, read.rows, strict=True):
        try:
            counts = dict(zip(COLUMNS[2:], map(int, cells), strict=True))
        except ValueError:
            raise InputError(f"{path}:{line}: got {cells}, expected whole numbers") from None
        found.setdefault(family, {})[entity] = counts
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
