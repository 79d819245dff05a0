"""The reasons why undetected mutants that are not proved equivalent are no holes of a bench."""

from __future__ import annotations

import re
import tomllib
from functools import cache
from pathlib import Path

FILE = Path(__file__).parent / "explained.toml"


def explanations(block: str, file: Path = FILE) -> dict[str, str]:
    """The reasons for a block, by a pattern of what mutants change."""
    entries = _read(file).get(block, [])
    return {entry["mutants"]: " ".join(entry["reason"].split()) for entry in entries}


@cache
def _read(file: Path) -> dict[str, list[dict[str, str]]]:
    """The file's entries by block. It is read only once, because many mutants are looked up."""
    return tomllib.loads(file.read_text(encoding="utf-8"))


def explain(block: str, what: str, file: Path = FILE) -> str:
    """The reason that is written for a mutant; empty where there is none."""
    for pattern, reason in explanations(block, file).items():
        if re.fullmatch(pattern, what):
            return reason
    return ""
