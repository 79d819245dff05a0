"""What the script of a certificate found."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Result:
    """The result of one step.

    Attributes
    ----------
    colour : str
        "green", "amber" or "red".
    step : str
    figure : str
        What was found, in words.
    """

    colour: str
    step: str
    figure: str


def read_results(folder: Path) -> list[Result]:
    """The results of the last run of a certificate's script."""
    text = (folder / "run" / "results.txt").read_text(encoding="utf-8")
    return [Result(*line.split("\t")) for line in text.splitlines()]
