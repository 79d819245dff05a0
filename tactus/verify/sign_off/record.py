"""Records of what was found for a block, so that datasheets and tests need not find it again.

A kind of record, such as "mutation", is one CSV file with a row for each block or recorded case of
it, sorted by name. A cell holds one field, as JSON if it is no text, or nothing where the record
has no such field.
"""

import csv
import json
import re
from pathlib import Path
from threading import Lock
from typing import Any

from golden.input_error import MissingFileError
from tactus.core.files import reading, replace_file
from tactus.core.hold import held

RECORDS = Path(__file__).parent / "records"
NAME = "block"
# So many hexadecimal digits of a digest are recorded: by chance, two differ in none of them once in
# 2**64.
DIGITS = 16
# Threads of a command write one after the other, as commands do.
BETWEEN = Lock()
DIGEST = re.compile(rf"\b([0-9a-f]{{{DIGITS}}})[0-9a-f]{{44,}}\b")


def short(facts: Any) -> Any:
    """Facts as they come back from a record, with the first digits of each digest."""
    return json.loads(DIGEST.sub(r"\1", json.dumps(facts)))


def write_record(kind: str, block: str, facts: dict[str, Any]) -> None:
    """Record what was found for a block."""
    with BETWEEN, held([RECORDS]):
        _write(kind, records(kind) | {block: short(facts)})


def _write(kind: str, records: dict[str, dict[str, Any]]) -> None:
    fields = sorted({field for record in records.values() for field in record})
    with (
        replace_file(_path(kind)) as temporary,
        temporary.open("w", newline="", encoding="utf-8") as file,
    ):
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow([NAME, *fields])
        for name, record in sorted(records.items()):
            rows.writerow([name, *(_cell(record, field) for field in fields)])


def _cell(record: dict[str, Any], field: str) -> str:
    if field not in record:
        return ""
    found = record[field]
    # A text stands as it is where it comes back as this text.
    plain = found and _value(str(found)) == found
    return str(found) if plain else json.dumps(found, sort_keys=True)


def _value(cell: str) -> Any:
    try:
        return json.loads(cell)
    except ValueError:
        return cell


def read_record(kind: str, block: str) -> dict[str, Any]:
    """The record of a block."""
    found = recorded(kind, block)
    if not found:
        raise MissingFileError(f"{_path(kind)}: no {kind} is recorded of {block}")
    return found


def recorded(kind: str, block: str) -> dict[str, Any]:
    """The record of a block; empty if there is none."""
    return records(kind).get(block, {})


def _path(kind: str) -> Path:
    return RECORDS / f"{kind}.csv"


def records(kind: str) -> dict[str, dict[str, Any]]:
    """All records of a kind, by the names of blocks and of recorded cases."""
    path = _path(kind)
    if not path.exists():
        return {}
    with reading(path, "a table of records"), path.open(newline="", encoding="utf-8") as file:
        return {
            row.pop(NAME): {field: _value(cell) for field, cell in row.items() if cell}
            for row in csv.DictReader(file)
        }
