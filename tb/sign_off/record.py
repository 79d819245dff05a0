"""Records of what was found for a block, so that datasheets and tests need not find it again."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from golden.files import read_json, write_json

RECORDS = Path(__file__).parent / "records"


def record_path(kind: str, block: str) -> Path:
    """The file of a record; ``kind`` is what was done with the block, such as "mutation"."""
    return RECORDS / kind / f"{block}.json"


def write_record(kind: str, block: str, facts: dict[str, Any]) -> None:
    """Record what was found for a block."""
    path = record_path(kind, block)
    write_json(path, facts, sort_keys=True)


def read_record(kind: str, block: str) -> dict[str, Any]:
    """The record of a block.

    Raises
    ------
    MissingFileError
        When nothing was recorded.
    """
    path = record_path(kind, block)
    facts: dict[str, Any] = read_json(path, "JSON", f"no {kind} is recorded of {block}")
    return facts
