"""Why a mutant that no bench finds, and that is not proved to be the same, is none of its holes."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

FILE = Path(__file__).parent / "explained.toml"


def explanations(block: str, file: Path = FILE) -> dict[str, str]:
    """By a pattern of what mutants change: the reason."""
    with file.open("rb") as handle:
        entries = tomllib.load(handle).get(block, [])
    return {entry["mutants"]: " ".join(entry["reason"].split()) for entry in entries}


def explain(block: str, what: str, file: Path = FILE) -> str:
    """The reason that is written of a mutant, or nothing."""
    for pattern, reason in explanations(block, file).items():
        if re.fullmatch(pattern, what):
            return reason
    return ""
