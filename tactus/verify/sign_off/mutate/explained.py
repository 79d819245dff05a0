"""The reasons why undetected mutants that are not proved equivalent are no holes of a bench."""

import re
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

FILE = Path(__file__).parent / "explained.toml"


def explanations(block: str, case: str) -> dict[str, str]:
    """The reasons for a block in a case of its bench, by a pattern of what mutants change.

    An entry that names no cases holds in all of them.
    """
    entries = [one for one in _entries().get(block, []) if case in one.get("cases", [case])]
    return {entry["mutants"]: " ".join(entry["reason"].split()) for entry in entries}


@cache
def _entries() -> dict[str, list[dict[str, Any]]]:
    """The entries by block. The file is read only once, because many mutants are looked up."""
    return tomllib.loads(FILE.read_text(encoding="utf-8"))


def explain(block: str, case: str, what: str) -> str:
    """The reason that is written for a mutant; empty where there is none."""
    for pattern, reason in explanations(block, case).items():
        if re.fullmatch(pattern, what):
            return reason
    return ""
