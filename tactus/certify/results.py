"""What the script of a certificate found."""

from dataclasses import dataclass
from pathlib import Path

# What the script writes. Not "run": Yosys as WebAssembly takes that for /run.
OUTPUT = "output"


@dataclass(frozen=True)
class StepResult:
    """The result of one step.

    colour: "green", "amber" or "red".
    figure: What was found, in words.
    """

    colour: str
    step: str
    figure: str


def read_results(folder: Path) -> list[StepResult]:
    """The results of a certificate's script, of its last run or so far; none before the first."""
    file = folder / OUTPUT / "results.txt"
    text = file.read_text(encoding="utf-8") if file.exists() else ""
    return [StepResult(*line.split("\t")) for line in text.splitlines()]
