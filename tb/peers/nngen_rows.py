"""NNgen: runs it, compares frames of its own simulation with its model, and counts the cells."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from golden.input_error import InputError
from golden.precision import SIGNAL
from tb.peers.cells import in_one_piece
from tb.peers.comparison import Row, Task
from tb.peers.installed import run_isolated

PROGRAM = Path(__file__).with_name("nngen_network.py")
TOP = "peer"


def row(python: Path, task: Task, folder: Path) -> Row:
    """The row of the network of ``nngen_network.py`` in one piece.

    Raises
    ------
    InputError
        When NNgen fails, or a simulated frame has other outputs than its model.
    """
    answer = run_isolated(python, PROGRAM, task.question(), folder)
    outputs, simulated = np.array(answer["outputs"]), np.array(answer["simulated"])
    wrong = int((outputs[: len(simulated)] != simulated).any(axis=1).sum())
    if wrong:
        raise InputError(
            f"NNgen: {wrong} of {len(simulated)} frames differ between simulation and model, "
            "expected none"
        )
    # NNgen's outputs are 16 bits wide, so they are limited to the range of a signal.
    errors = task.errors(np.clip(outputs, SIGNAL.low, SIGNAL.high))
    name = f"NNgen, table of {answer['words']} words"
    clocks = answer["clocks"]
    return Row(name, in_one_piece(folder, TOP), clocks, clocks, errors)
