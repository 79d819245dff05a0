"""da4ml: tries its settings, simulates the Verilog that it writes, and counts the cells."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from golden.fixed import Codes
from golden.input_error import InputError
from tb.peers.cells import in_one_piece
from tb.peers.comparison import Row, Task
from tb.peers.installed import run_isolated
from tb.peers.simulated import simulated

PROGRAM = Path(__file__).with_name("da4ml_network.py")
TOP = "peer"
# Changes of the files that da4ml writes. Yosys knows no memory of LUTs for Virtex-II and stops with
# an error there; without the attribute it takes block RAMs.
NEEDED = {"lookup_table.v": (r"\(\* rom_style.*?\*\)", "")}
# A sum with this attribute is not merged with others into carry-save form, which takes more LUTs.
KEPT = {"shift_adder.v": (r"(wire \[[^]]*\] accum;)", r"(* keep *) \1")}


@dataclass(frozen=True)
class Tried:
    """A setting that was tried.

    Attributes
    ----------
    setting : str
    cost : float
        The cost as da4ml counts it.
    clocks : int
    outputs : integer array, shape (frames, outputs)
        The outputs of da4ml's own integer model.
    folder : Path
        The folder with its Verilog.
    """

    setting: str
    cost: float
    clocks: int
    outputs: Codes
    folder: Path


def tried(python: Path, task: Task, folder: Path) -> list[Tried]:
    """Try every setting of ``da4ml_network.py``.

    Raises
    ------
    InputError
        When da4ml fails.
    """
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

    Raises
    ------
    InputError
        When there is no such setting.
    """
    good = [
        one
        for one in found
        if all(e <= m for e, m in zip(task.errors(one.outputs), most, strict=True))
    ]
    if not good:
        raise InputError(f"da4ml: no setting has errors of at most {most}")
    return min(good, key=lambda one: one.cost)


def collected(one: Tried, folder: Path, edits: dict[str, tuple[str, str]]) -> None:
    """Copy a setting's Verilog and tables into one folder, and change them by ``edits``.

    Raises
    ------
    InputError
        When a text to change is not there, because another version of da4ml writes other text.
    """
    source = one.folder / "src"
    for file in (*source.glob("*.v"), *source.glob("static/*.v"), *source.glob("memfiles/*.mem")):
        if file.name != f"{TOP}_wrapper.v":
            shutil.copy(file, folder)
    for name, (pattern, text) in edits.items():
        path = folder / name
        changed, count = re.subn(pattern, text, path.read_text(encoding="utf-8"))
        if count != 1:
            raise InputError(f"da4ml: {name}: got {count} times {pattern}, expected once")
        path.write_text(changed, encoding="utf-8")


def row(one: Tried, task: Task, verilog: Path, kept: bool) -> Row:
    """The row of a setting in one piece, as it is written or with its sums kept.

    Raises
    ------
    InputError
        When the Verilog does not compute what da4ml's model does, or when a tool fails.
    """
    verilog.mkdir()
    collected(one, verilog, NEEDED | KEPT if kept else NEEDED)
    outputs = simulated(verilog, TOP, task.frames, one.outputs.shape[1], one.clocks)
    check(outputs, one.outputs)
    name = "da4ml, sums kept" if kept else "da4ml, as written"
    return Row(name, in_one_piece(verilog, TOP), one.clocks, 1, task.errors(outputs))


def check(found: Codes, expected: Codes) -> None:
    """Refuse Verilog that differs from da4ml's model.

    Raises
    ------
    InputError
        When a frame has other outputs.
    """
    wrong = int((found != expected).any(axis=1).sum())
    if wrong:
        raise InputError(
            f"da4ml: {wrong} of {len(expected)} frames differ between simulation and model, "
            "expected none"
        )
