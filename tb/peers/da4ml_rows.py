"""da4ml: tries its settings, simulates the Verilog that it writes, and counts the cells."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from golden.fixed import Codes
from golden.input_error import InputError
from golden.networks.designs import DESIGNS
from golden.networks.settings import Settings
from tb.peers.cells import in_one_piece
from tb.peers.collected import KEPT, Edits, collected
from tb.peers.comparison import MAIN, Row, Task
from tb.peers.installed import installed, pinned, run_isolated
from tb.peers.simulated import check

PROGRAM = Path(__file__).with_name("da4ml_network.py")
VERSION = f"da4ml {pinned('da4ml')}"
# Changes of the files that da4ml writes. Yosys knows no memory of LUTs for Virtex-II and stops with
# an error there; without the attribute it takes block RAMs.
EDITS: Edits = [("lookup_table.v", r"\(\* rom_style.*?\*\)", ""), *KEPT]
# da4ml may have errors of up to ``MORE`` times those of this design.
MEASURE = "parallel"
MORE = 1.2


@dataclass(frozen=True)
class Tried:
    """A setting that was tried.

    cost: The cost as da4ml counts it.
    outputs, shape (frames, outputs): The outputs of da4ml's own integer model.
    folder: The folder with its Verilog.
    """

    setting: str
    cost: float
    clocks: int
    outputs: Codes
    folder: Path


def brought(folder: Path) -> Path:
    """The Python of an environment with da4ml; see ``installed``."""
    return installed(folder, "da4ml")


def tried(python: Path, task: Task, folder: Path) -> list[Tried]:
    """Try every setting of ``da4ml_network.py``."""
    answers = run_isolated(python, PROGRAM, task.question(), folder)
    return [
        Tried(
            f"{one['method0']}, {one['hard_dc']}, q in {one['hidden_frac']} fraction bits",
            one["cost"],
            # The outputs have a register behind the last stage.
            one["stages"] + 1,
            np.array(one["outputs"], dtype=np.int64),
            folder / str(number),
        )
        for number, one in enumerate(answers)
    ]


def cheapest(found: Iterable[Tried], task: Task, most: tuple[float, float]) -> Tried:
    """The setting with the least cost whose errors are at most ``most``.

    Both the errors over the recorded frames and those over the random frames are limited.
    """
    good = [
        one
        for one in found
        if all(e <= m for e, m in zip(task.errors(one.outputs), most, strict=True))
    ]
    if not good:
        raise InputError(f"da4ml: no setting has errors of at most {most}")
    return min(good, key=lambda one: one.cost)


def rows(python: Path, tasks: Mapping[str, Task], folder: Path) -> Iterator[Row]:
    """The row of the cheapest setting whose errors are near those of our design."""
    task = tasks[MAIN]
    measure = DESIGNS[MEASURE].of([task.mlp], Settings(task.constants.precision))
    recorded, random = task.errors(measure.process(task.frames))
    one = cheapest(tried(python, task, folder), task, (MORE * recorded, MORE * random))
    verilog = folder / "kept"
    collected("da4ml", one.folder / "src", verilog, EDITS)
    check("da4ml", verilog, task.frames, one.outputs, one.clocks)
    name = f"da4ml, sums kept ({one.setting})"
    errors = task.errors(one.outputs)
    yield Row(task.name, name, in_one_piece(verilog, "peer"), one.clocks, 1, errors)
