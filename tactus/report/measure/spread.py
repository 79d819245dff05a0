"""``python -m tactus.report.measure.spread``: measures how floating-point figures depend on a
processor.

On another processor numpy, OpenBLAS and glibc use other instructions, which round the last bit
differently. Environment variables make this processor compute as others do. Each setting runs in
processes of its own.

    python -m tactus.report.measure.spread swing beam

It measures tables of ``make figures``, by default all, under every setting. For each column it
prints the largest difference between two settings. ``--python`` adds another interpreter, with
other versions of numpy and SciPy.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from tactus.core import machine
from tactus.core.cli import run, stop_if_dry_run
from tactus.core.fingerprint import ROOT
from tactus.report.measure.table import Cell, Table

SETTINGS: dict[str, dict[str, str]] = {
    "as it is": {},
    **machine.SETTINGS,
    "openblas-nehalem": {"OPENBLAS_CORETYPE": "Nehalem"},
    "oldest": machine.SETTINGS["numpy-sse"]
    | machine.SETTINGS["glibc-sse"]
    | machine.SETTINGS["openblas-prescott"]
    | machine.SETTINGS["one-thread"],
}
Tables = Mapping[str, Mapping[str, Any]]


def finished(command: Sequence[str], setting: Mapping[str, str]) -> bool:
    """Run a command, and return whether this processor has the instructions for it."""
    done = subprocess.run(
        command, cwd=ROOT, env=os.environ | setting, capture_output=True, text=True, check=False
    )
    if done.returncode > 0:
        raise InputError(f"{' '.join(command)}: {done.stderr.strip()}")
    return done.returncode == 0


def runs(settings: Sequence[str], pythons: Sequence[str]) -> Iterator[tuple[str, str, str]]:
    """The name, the interpreter and the setting of every run."""
    for setting in settings:
        yield setting, sys.executable, setting
    for python in pythons:
        yield python, python, "as it is"


def differences(found: Mapping[str, Tables]) -> Table:
    """The columns in which runs differ, and the two figures that are farthest apart.

    found: The tables of each run, as ``figures.json`` holds them.
    """
    rows: list[list[Cell]] = []
    for name, first in next(iter(found.values())).items():
        runs_rows = [tables[name]["rows"] for tables in found.values()]
        fewest, most = min(map(len, runs_rows)), max(map(len, runs_rows))
        if fewest < most:
            rows.append([name, "number of rows", 1 - fewest / most, fewest, most, None])
        for c, column in enumerate(first["columns"]):
            worst: list[Cell] = []
            for row, cells in enumerate(zip(*runs_rows, strict=False), start=1):
                values = [cell[c] for cell in cells]
                if any(isinstance(value, str) or value is None for value in values):
                    if len(set(values)) > 1:
                        worst = [None, None, None, row]
                        break
                    continue
                low, high = min(values), max(values)
                share = (high - low) / max(abs(low), abs(high), sys.float_info.min)
                if share > (worst[0] if worst else 0):
                    worst = [share, low, high, row]
            if worst:
                rows.append([name, column, *worst])
    return Table(
        "spread",
        ["table", "column", "largest difference", "from", "to", "row"],
        rows,
        f"The figures are the largest differences between {len(found)} runs, as a part of the "
        "figure, and where they are. A cell is empty where one of the two has text or no figure. "
        f"Columns that are not named are the same in all runs. Runs: {', '.join(found)}.",
    )


def figures(names: Sequence[str], settings: Sequence[str], pythons: Sequence[str]) -> Table:
    """Measure tables under every setting, and return the differences."""
    found: dict[str, Tables] = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, python, setting in runs(settings, pythons):
            command = [python, "-m", "tactus.report.measure", *names, "--build", folder]
            ready = finished(command, SETTINGS[setting])
            if ready:
                path = Path(folder) / "figures" / "figures.json"
                found[name] = json.loads(path.read_text(encoding="utf-8"))["tables"]
            print(f"{name}: {'measured' if ready else 'not possible here'}", flush=True)
    return differences(found)


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m tactus.report.measure.spread",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("tables", nargs="*", metavar="TABLE")
    parser.add_argument("--setting", action="append", choices=SETTINGS)
    parser.add_argument("--python", action="append", default=[])
    arguments = parser.parse_args()
    settings = arguments.setting or list(SETTINGS)
    stop_if_dry_run(f"measure under {len(settings)} settings of this machine what differs")
    table = figures(arguments.tables, settings, arguments.python)
    print("\n".join(table.lines()))


if __name__ == "__main__":
    sys.exit(run(main))
