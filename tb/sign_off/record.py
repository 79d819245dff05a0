"""What was found of a block, recorded, so that datasheets and tests need not find it again."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from golden.files import check_file, reading, replace_file

RECORDS = Path(__file__).parent / "records"


def record_path(kind: str, block: str) -> Path:
    """Where it stands what was found of a block; ``kind`` is what was done, such as "mutation"."""
    return RECORDS / kind / f"{block}.json"


def write_record(kind: str, block: str, facts: dict[str, Any]) -> None:
    """Record what was found."""
    path = record_path(kind, block)
    path.parent.mkdir(parents=True, exist_ok=True)
    with replace_file(path) as temporary:
        text = json.dumps(facts, indent=1, sort_keys=True, ensure_ascii=False)
        temporary.write_text(text + "\n", encoding="utf-8")


def read_record(kind: str, block: str) -> dict[str, Any]:
    """What was recorded.

    Raises
    ------
    FileNotFoundError
        When nothing was.
    """
    path = record_path(kind, block)
    check_file(path, f"no {kind} is recorded of {block}")
    with reading(path, "JSON"):
        facts: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return facts
