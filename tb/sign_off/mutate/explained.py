"""Why a mutant that no bench finds, and that is not proved to be the same, is none of its holes."""

from __future__ import annotations

import re
import tomllib
from functools import cache
from pathlib import Path

FILE = Path(__file__).parent / "explained.toml"


def explanations(block: str, file: Path = FILE) -> dict[str, str]:
    """By a pattern of what mutants change: the reason."""
    entries = _read(file).get(block, [])
    return {entry["mutants"]: " ".join(entry["reason"].split()) for entry in entries}


@cache
def _read(file: Path) -> dict[str, list[dict[str, str]]]:
    """The file's entries by block, read once: each of many mutants is looked for in it."""
    return tomllib.loads(file.read_text(encoding="utf-8"))


def explain(block: str, what: str, file: Path = FILE) -> str:
    """The reason that is written of a mutant, or nothing."""
    for pattern, reason in explanations(block, file).items():
        if re.fullmatch(pattern, what):
            return reason
    return ""
