"""The network as a program in C for a processor: its constants, its model, and its clocks.

``program.c`` is the same for all processors. A header for each says what differs.
"""

import shutil
from pathlib import Path
from typing import Any

import numpy as np

from golden.activation.bipartite import bipartite_for
from golden.activation.bipartite_table import BLOCK_RAM, RESULT, bipartite_table
from golden.numbers.fixed import Codes
from golden.numbers.precision import EXACT, SIGNAL
from studies.peers.comparison import Task

HERE = Path(__file__).parent
SOURCE = "program.c"


def layers(task: Task) -> list[tuple[Codes, Codes, int]]:
    """Weights, biases with the fraction bits of a product, and the bits below a result."""
    first, second = task.constants.first, task.constants.second
    cut = SIGNAL.frac + first.fmt.frac - EXACT.hidden_fmt.frac
    last = RESULT.frac + second.fmt.frac - SIGNAL.frac
    weights = np.array(second.weights)
    # A code of r stands for the middle of its step, and an output is rounded half up.
    half = (weights.sum(axis=1) >> 1) + (1 << last >> 1)
    return [
        (np.array(first.weights), np.array(first.biases) << SIGNAL.frac, cut),
        (weights, (np.array(second.biases) << RESULT.frac) + half, last),
    ]


def model(task: Task) -> Codes:
    """The outputs that the program has to compute for the frames of the task."""
    (weights, biases, cut), (outer, outer_biases, last) = layers(task)
    fmt = EXACT.hidden_fmt
    q = np.clip((task.frames @ weights.T + biases) >> cut, fmt.low, fmt.high)
    r = bipartite_for(EXACT, 1, fmt.high).process(q)
    result: Codes = np.clip((r @ outer.T + outer_biases) >> last, SIGNAL.low, SIGNAL.high)
    return result


def header(task: Task) -> str:
    """``network.h``, which the program includes."""
    (weights, biases, cut), (outer, outer_biases, last) = layers(task)
    table = bipartite_table(BLOCK_RAM)
    sizes = {
        "INPUTS": weights.shape[1],
        "HIDDEN": len(weights),
        "OUTPUTS": len(outer),
        "FIRST_SHIFT": cut,
        "SECOND_SHIFT": last,
    }
    arrays: dict[str, Any] = {
        "int32_t first_weights[HIDDEN][INPUTS]": weights.tolist(),
        "int64_t first_biases[HIDDEN]": biases.tolist(),
        "int32_t second_weights[OUTPUTS][HIDDEN]": outer.tolist(),
        "int64_t second_biases[OUTPUTS]": outer_biases.tolist(),
        "int32_t bases[]": list(table.bases),
        "int16_t corrections[]": list(table.corrections),
    }
    lines = [f"#define {name} {value}" for name, value in sizes.items()]
    for name, values in arrays.items():
        text = str(values).replace("[", "{").replace("]", "}")
        lines.append(f"TABLE {name} = {text};")
    return "\n".join([*lines, ""])


def written(task: Task, platform: str, folder: Path) -> None:
    """Write the sources of the program for a processor, whose header is ``platform``."""
    (folder / "network.h").write_text(header(task), encoding="utf-8")
    shutil.copy(HERE / platform, folder / "platform.h")
    shutil.copy(HERE / SOURCE, folder)


def timed(printed: str, inputs: int, outputs: int) -> tuple[Codes, int, int]:
    """The outputs that a simulator printed, the most clocks of a frame, and from frame to frame.

    printed: A line ``taken CLOCK`` for each sample, and a line ``given CLOCK CODE`` for each
        output; other lines are the simulator's own.
    inputs, outputs: How many samples and outputs a frame has.
    """
    lines = [line.split() for line in printed.splitlines()]
    taken = np.array([int(line[1]) for line in lines if line[:1] == ["taken"]])
    given = np.array([line[1:] for line in lines if line[:1] == ["given"]], dtype=np.int64)
    ends = given[outputs - 1 :: outputs, 0]
    last = taken[inputs - 1 :: inputs][: len(ends)]
    codes: Codes = given[:, 1].reshape(-1, outputs)
    return codes, int((ends - last).max()), int(np.diff(ends).max())
