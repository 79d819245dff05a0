"""The figures of the thesis with which a scene is compared."""

import tomllib
from functools import cache
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from tactus.core.fingerprint import ROOT

NUMBERS = ROOT / "scenes" / "data" / "thesis_numbers.toml"


@cache
def _numbers() -> dict[str, Any]:
    return tomllib.loads(NUMBERS.read_text(encoding="utf-8"))


def thesis_table(key: str) -> dict[str, Any]:
    """A table of scenes/data/thesis_numbers.toml by its dotted name; empty if there is none."""
    table: Any = _numbers()
    for part in key.split("."):
        table = table.get(part) if isinstance(table, dict) else None
    return table if isinstance(table, dict) else {}


def thesis_figures(key: str, outputs: int, path: Path) -> list[float]:
    """The largest mean errors of the thesis that a scene names, in percent, one for each output."""
    figures = thesis_table(key).get("simulation")
    if figures is None or len(figures) != outputs:
        raise InputError(
            f"{path}: data.reference: got {key!r}, expected a table of thesis_numbers.toml with "
            f"{outputs} simulation figures, such as digit.hybrid"
        )
    return [float(figure) for figure in figures]
