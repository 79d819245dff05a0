"""``make study NAME=beans``: measures a study again and prints what differs from its result.csv."""

import argparse
import math
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

from golden.input_error import InputError, suggest
from tactus.core.cli import run, stop_if_dry_run
from tactus.core.files import replace_file
from tactus.core.folders import BUILD
from tactus.report.measure.table import Cell, Table, cell_text, read_csv

FOLDER = Path(__file__).parent
Row = dict[str, Cell]


def names() -> list[str]:
    """Every study that can be measured again."""
    return sorted(path.parent.name for path in FOLDER.glob("*/study.py"))


def recorded(name: str) -> Table:
    """What a study found."""
    return Table(name, *read_csv(FOLDER / name / "result.csv"), "")


def measured(name: str) -> Iterator[Row]:
    """What a study finds now, row by row."""
    rows: Iterator[Row] = import_module(f"studies.{name}.study").rows()
    return rows


def differences(old: Table, new: Table) -> Iterator[str]:
    """A line for each cell that is not as recorded."""
    if (list(old.columns), len(old.rows)) != (list(new.columns), len(new.rows)):
        yield f"recorded {len(old.rows)} rows of {', '.join(old.columns)}"
        yield f"measured {len(new.rows)} rows of {', '.join(new.columns)}"
        return
    for number, (before, now) in enumerate(zip(old.rows, new.rows, strict=True), 1):
        for column, was, found in zip(old.columns, before, now, strict=True):
            if not same(was, found):
                yield f"row {number}: {column}: recorded {was}, measured {found}"


def same(one: Cell, other: Cell, within: float = 1e-6) -> bool:
    """Whether two cells are equal, numbers but for last digits."""
    if isinstance(one, str) or isinstance(other, str) or one is None or other is None:
        return one == other
    return math.isclose(one, other, rel_tol=within, abs_tol=1e-12)


def main() -> None:
    parser = argparse.ArgumentParser(prog="make study", description=__doc__)
    parser.add_argument("name", metavar="NAME")
    parser.add_argument("--record", action="store_true")
    arguments = parser.parse_args()
    name = arguments.name
    if name not in names():
        raise InputError(
            f"NAME={name}: no such study, expected one of {', '.join(names())}"
            f"{suggest(name, names())}"
        )
    result = FOLDER / name / "result.csv" if arguments.record else BUILD / "studies" / f"{name}.csv"
    stop_if_dry_run(f"measure {name} and write {result}")
    found = []
    for row in measured(name):
        print(", ".join(f"{column} {cell_text(cell)}" for column, cell in row.items()), flush=True)
        found.append(row)
    table = Table(name, list(found[0]), [list(row.values()) for row in found], "")
    if not arguments.record:
        print("\n".join(differences(recorded(name), table)) or f"all as in {name}/result.csv")
    with replace_file(result) as temporary:
        table.write_csv(temporary)


if __name__ == "__main__":
    sys.exit(run(main))
