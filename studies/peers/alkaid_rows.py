"""alkaid: runs it, simulates the Verilog that it writes, and counts the cells."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from golden.activation.bipartite_table import BLOCK_RAM, bipartite_table
from studies.peers.cells import in_one_piece
from studies.peers.collected import ADDER, KEPT, Edits, collected
from studies.peers.comparison import Row, Task
from studies.peers.installed import installed, run_isolated
from studies.peers.simulated import check

PROGRAM = Path(__file__).with_name("alkaid_network.py")
# A difference whose second operand has the lower last place is written as two: the lower bits, and
# the upper ones less a borrow, which Yosys builds as a sum of three. Here it is one difference.
WHOLE: Edits = [
    (ADDER, r"if \(SHIFT1 == 0\)", "if (SHIFT1 == 0 || (SHIFT1 < 0 && IS_SUB == 1))"),
]
# The rows: the operands of an adder, and the changes of its Verilog.
WAYS: dict[str, tuple[str, Edits]] = {
    "sums of two": ("two", [*KEPT, *WHOLE]),
    "sums of three": ("three", []),
}
# The lowest bits that the weights of the second layer do without, so that errors are near those of
# our design. One bit less in the first layer already raises errors by a third above these.
LEFT_OUT = {"digit-fast-full": 2}


def download(folder: Path) -> Path:
    """The Python of an environment with alkaid; see ``installed``."""
    return installed(folder, "alkaid")


def question(task: Task) -> dict[str, Any]:
    """The task with rounded weights, and the words of our tables, in a form for JSON."""
    table = bipartite_table(BLOCK_RAM)
    asked = task.question()
    below = LEFT_OUT.get(task.name, 0)
    codes = np.array(asked["second"]["weights"])
    rounded = (codes + (1 << below >> 1)) >> below << below
    asked["second"] = {**asked["second"], "weights": rounded.tolist()}
    return {**asked, "bases": table.bases, "corrections": table.corrections}


def rows(python: Path, tasks: Mapping[str, Task], folder: Path) -> Iterator[Row]:
    """The rows of the networks of ``alkaid_network.py``."""
    for task in tasks.values():
        place = folder / task.name
        place.mkdir()
        answer = run_isolated(python, PROGRAM, question(task), place)
        outputs = np.array(answer["outputs"], dtype=np.int64)
        for way, (operands, edits) in WAYS.items():
            verilog = place / way.replace(" ", "_")
            collected("alkaid", place / operands / "src", verilog, edits)
            clocks = answer["clocks"][operands]
            check("alkaid", verilog, task.frames, outputs, clocks)
            cells = in_one_piece(verilog, "peer")
            yield Row(task.name, f"alkaid, {way}", cells, clocks, 1, task.errors(outputs))
