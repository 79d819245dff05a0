"""NNgen: runs it, compares frames of its own simulation with its model, and counts the cells."""

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from golden.precision import SIGNAL
from tb.peers.cells import in_one_piece
from tb.peers.comparison import MAIN, Row, Task
from tb.peers.installed import installed, pinned, run_isolated
from tb.peers.simulated import agree

PROGRAM = Path(__file__).with_name("nngen_network.py")
VERSION = f"NNgen {pinned('nngen')}"


def brought(folder: Path) -> Path:
    """The Python of an environment with NNgen; see ``installed``."""
    return installed(folder, "nngen")


def rows(python: Path, tasks: Mapping[str, Task], folder: Path) -> Iterator[Row]:
    """The row of the network of ``nngen_network.py``."""
    task = tasks[MAIN]
    answer = run_isolated(python, PROGRAM, task.question(), folder)
    outputs, simulated = np.array(answer["outputs"]), np.array(answer["simulated"])
    agree("NNgen", simulated, outputs[: len(simulated)])
    # NNgen's outputs are 16 bits wide, so they are limited to the range of a signal.
    errors = task.errors(np.clip(outputs, SIGNAL.low, SIGNAL.high))
    name = f"NNgen, table of {answer['words']} words"
    clocks = answer["clocks"]
    yield Row(task.name, name, in_one_piece(folder, "peer"), clocks, clocks, errors)
