"""``python -m tb.report.measure.spread``: measures how floating-point figures depend on a
processor.

On another processor numpy, OpenBLAS and glibc use other instructions, which round the last bit
differently. Environment variables make this processor compute as others do. Each setting runs in
processes of its own.

    python -m tb.report.measure.spread figures swing beam
    python -m tb.report.measure.spread training docs/tutorial/rig.toml --moved 30

``figures`` measures tables of ``make figures``, by default all, under every setting. For each
column it prints the largest difference between two settings. ``training`` trains a scene under
every setting. With ``--moved`` it also trains so many times from starting weights that are changed
by last bits, which has the same effect as another processor. ``--python`` adds another interpreter,
with other versions of numpy and SciPy.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from golden import machine
from golden.cli import run, would
from golden.fingerprint import ROOT
from golden.input_error import InputError
from golden.mlp import Mlp
from golden.network_files.network_file import provenance_path
from golden.real import Real
from golden.scene import Scene, load_scene
from golden.training.objective import Descend, Objective
from golden.training.search import bit_true_errors, candidates, train
from golden.training.task import task_for
from tb.report.measure.table import Cell, Table

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
            command = [python, "-m", "tb.report.measure", *names, "--build", folder]
            ready = finished(command, SETTINGS[setting])
            if ready:
                path = Path(folder) / "figures" / "figures.json"
                found[name] = json.loads(path.read_text(encoding="utf-8"))["tables"]
            print(f"{name}: {'measured' if ready else 'not possible here'}", flush=True)
    return differences(found)


class Moved(Objective):
    """An objective whose descents start with weights that are changed by a last bit or two."""

    def __init__(self, number: int, *args: Any) -> None:
        super().__init__(*args)
        self.number = number

    def search(self, descend: Descend, start: Real, steps: int) -> Real:
        bits = np.random.default_rng([self.number, len(start)]).integers(-2, 3, len(start))
        return super().search(descend, start * (1 + bits * np.finfo(np.float64).eps), steps)


@dataclass(frozen=True)
class Trained:
    """A network of a scene, and its rms errors in percent on rows that did not train it."""

    mlp: Mlp
    validation: float
    held_out: float


def moved(scene: Scene, number: int) -> Iterator[Trained]:
    """The networks of the scene, from starts that are changed by last bits."""
    chosen: list[Mlp] = []
    for _ in scene.members:
        task = task_for(scene, scene.vectors(), chosen)
        found: list[Trained] = []
        for hidden, restart in candidates(task):
            # A candidate that the formats cannot hold is left out.
            with suppress(InputError):
                mlp = train(task, hidden, restart, partial(Moved, number))
                found.append(Trained(mlp, *bit_true_errors(task, mlp)))
        best = min(found, key=lambda trained: trained.validation)
        chosen.append(best.mlp)
        yield best


def written(scene: Scene, folder: Path) -> Iterator[Trained]:
    """The networks that ``make train`` wrote into a folder, with their stated errors."""
    for member in scene.members:
        path = folder / member.weights_path.name
        story = tomllib.loads(provenance_path(path).read_text(encoding="utf-8"))
        # These errors are measured as in ``moved``: with noise and drift, if the scene names some.
        disturbed = "_disturbed" if not scene.training.disturbance.none else ""
        errors = (story[f"{part}{disturbed}_rms_percent"] for part in ("validation", "test"))
        mlp = replace(member, weights_path=path).load()
        assert isinstance(mlp, Mlp), f"{path} is not what a search trains"
        yield Trained(mlp, *errors)


def training(scene: Scene, settings: Sequence[str], pythons: Sequence[str], more: int = 0) -> Table:
    """Train a scene under every setting. The table has the sum of ``|w1|`` and the errors."""
    found: dict[str, list[Trained]] = {}
    for name, python, setting in runs(settings, pythons):
        with tempfile.TemporaryDirectory() as folder:
            command = [python, "-m", "golden.commands.train", str(scene.path.resolve())]
            command += ["--into", folder, "--build", f"{folder}/build"]
            if finished(command, SETTINGS[setting]):
                found[name] = list(written(scene, Path(folder)))
            else:
                print(f"{name}: not possible here", flush=True)
    for number in range(1, more + 1):
        found[f"moved start {number}"] = list(moved(scene, number))
    rows: list[list[Cell]] = []
    for n, member in enumerate(scene.members):
        output = ", ".join(member.outputs)
        figures = {
            name: (float(np.abs(t.mlp.w1).sum()), t.validation, t.held_out)
            for name, t in ((name, networks[n]) for name, networks in found.items())
        }
        rows += [[output, name, *values] for name, values in figures.items()]
        for kind, pick in (("least", min), ("most", max)):
            rows.append([output, kind, *map(pick, zip(*figures.values(), strict=True))])
    return Table(
        "spread",
        ["network", "setting", "sum of |w1|", "validation %", "held out %"],
        rows,
        "The figures are root mean squares of the bit-true percent errors, on the rows that chose "
        "the network and on the rows that took no part.",
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m tb.report.measure.spread",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    kinds = parser.add_subparsers(dest="kind", required=True)
    tables, scene = kinds.add_parser("figures"), kinds.add_parser("training")
    tables.add_argument("tables", nargs="*", metavar="TABLE")
    scene.add_argument("scene")
    scene.add_argument("--moved", type=int, default=0, metavar="N")
    for kind in (tables, scene):
        kind.add_argument("--setting", action="append", choices=SETTINGS)
        kind.add_argument("--python", action="append", default=[])
    arguments = parser.parse_args()
    settings = arguments.setting or list(SETTINGS)
    would(f"measure under {len(settings)} settings of this machine what differs")
    if arguments.kind == "figures":
        table = figures(arguments.tables, settings, arguments.python)
    else:
        known = load_scene(arguments.scene)
        table = training(known, settings, arguments.python, arguments.moved)
    print("\n".join(table.lines()))


if __name__ == "__main__":
    sys.exit(run(main))
