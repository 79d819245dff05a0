"""NNgen: the Verilog that it writes, frames of its own simulation, and its cells."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from golden.cli import CommandError
from golden.precision import SIGNAL
from tb.peers.cells import in_one_piece
from tb.peers.comparison import Row, Task
from tb.peers.installed import asked

PROGRAM = Path(__file__).with_name("nngen_network.py")
TOP = "peer"


def rows(python: Path, task: Task, folder: Path) -> list[Row]:
    """Each setting of ``nngen_network.py`` in one piece.

    Raises
    ------
    CommandError
        When NNgen fails, or a simulated frame has other outputs than its model.
    """
    found = []
    for number, one in enumerate(asked(python, PROGRAM, task.given(), folder)):
        outputs, simulated = np.array(one["outputs"]), np.array(one["simulated"])
        wrong = int((outputs[: len(simulated)] != simulated).any(axis=1).sum())
        if wrong:
            raise CommandError(
                f"NNgen: {wrong} of {len(simulated)} frames are other in simulation than in its "
                "model"
            )
        # Its outputs are 16 bits wide.
        errors = task.errors(np.clip(outputs, SIGNAL.low, SIGNAL.high))
        cells = in_one_piece(folder / str(number), TOP)
        name = f"NNgen, table of {1 << one['address']} words"
        found.append(Row(name, cells, one["clocks"], one["clocks"], errors))
    return found
