"""SERV: compiles the network for this bit-serial RISC-V, measures its clocks, counts the cells."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from golden.activation.bipartite import bipartite_for
from golden.activation.bipartite_table import BLOCK_RAM, RESULT, bipartite_table
from golden.fixed import Codes
from golden.input_error import InputError
from golden.precision import EXACT, SIGNAL
from tb.peers.cells import in_one_piece
from tb.peers.comparison import MAIN, Row, Task
from tb.peers.installed import installed, pinned, run
from tb.peers.simulated import agree

PACKAGE = "pythondata-cpu-serv"
VERSION = f"SERV as {PACKAGE} {pinned(PACKAGE)}"
TOOLS = "riscv64-unknown-elf"
OPTIONS = ["-march=rv32i", "-mabi=ilp32", "-O2", "-ffreestanding", "-nostdlib"]
HERE = Path(__file__).parent
# Bytes of the memory for program and data.
MEMORY = 16384
# The frames that are simulated.
SIMULATED = 4


def brought(folder: Path) -> Path:
    """The folder with SERV's Verilog, in an environment with its package; see ``installed``.

    Raises
    ------
    InputError
        Also when there is no compiler for RISC-V.
    """
    try:
        run([f"{TOOLS}-gcc", "--version"])
    except InputError as error:
        raise InputError(f"{error}; apt-get install gcc-{TOOLS}") from None
    installed(folder, PACKAGE)
    (verilog,) = folder.glob("lib/*/site-packages/pythondata_cpu_serv/verilog/rtl")
    return verilog


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
    """``network.h``, which ``serv_network.c`` includes."""
    (weights, biases, cut), (outer, outer_biases, last) = layers(task)
    table = bipartite_table(BLOCK_RAM)
    sizes = {
        "MEMORY": MEMORY,
        "INPUTS": weights.shape[1],
        "HIDDEN": len(weights),
        "OUTPUTS": len(outer),
        "FIRST_SHIFT": cut,
        "SECOND_SHIFT": last,
    }
    arrays: dict[str, Any] = {
        "int first_weights[HIDDEN][INPUTS]": weights.tolist(),
        "long long first_biases[HIDDEN]": biases.tolist(),
        "int second_weights[OUTPUTS][HIDDEN]": outer.tolist(),
        "long long second_biases[OUTPUTS]": outer_biases.tolist(),
        "int bases[]": list(table.bases),
        "short corrections[]": list(table.corrections),
    }
    lines = [f"#define {name} {value}" for name, value in sizes.items()]
    for name, values in arrays.items():
        text = str(values).replace("[", "{").replace("]", "}")
        lines.append(f"static const {name} = {text};")
    return "\n".join([*lines, ""])


def compiled(task: Task, folder: Path) -> None:
    """Write ``program.mem``, the words of the memory.

    Raises
    ------
    InputError
        When the compiler fails, or when the program does not fit.
    """
    (folder / "network.h").write_text(header(task), encoding="utf-8")
    shutil.copy(HERE / "serv_network.c", folder)
    # The first instruction is at address 0.
    places = ["-Wl,--section-start=.start=0,-Ttext=0x10,--entry=start"]
    run([f"{TOOLS}-gcc", *OPTIONS, *places, "-o", "program", "serv_network.c", "-lgcc"], folder)
    run([f"{TOOLS}-objcopy", "-O", "binary", "program", "program.bin"], folder)
    found = (folder / "program.bin").read_bytes()
    if len(found) > MEMORY:
        raise InputError(f"SERV: the program takes {len(found)} bytes, expected {MEMORY} at most")
    words = np.frombuffer(found.ljust(MEMORY, b"\0"), "<u4")
    (folder / "program.mem").write_text("".join(f"{word:08x}\n" for word in words))


def played(frames: Codes, outputs: int, folder: Path) -> tuple[Codes, int, int]:
    """The outputs of frames in Icarus, the clocks of a frame, and those from frame to frame."""
    mask = (1 << SIGNAL.width) - 1
    samples = [f"{code & mask:x}\n" for code in frames.ravel().tolist()]
    (folder / "samples.hex").write_text("".join(samples), encoding="utf-8")
    sizes = [f"-Pplay.SAMPLES={frames.size}", f"-Pplay.RESULTS={len(frames) * outputs}"]
    sources = [*sorted(file.name for file in folder.glob("*.v")), str(HERE / "serv_bench.v")]
    run(["iverilog", "-g2012", "-s", "play", *sizes, "-o", "play.vvp", *sources], folder)
    lines = [line.split() for line in run(["vvp", "-n", "play.vvp"], folder).splitlines()]
    taken = [int(clock) for kind, clock, *_ in lines if kind == "taken"]
    given = [(int(clock), int(code)) for kind, clock, *rest in lines if rest for code in rest]
    ends = np.array([clock for clock, _ in given])[outputs - 1 :: outputs]
    last = np.array(taken)[frames.shape[1] - 1 :: frames.shape[1]][: len(ends)]
    codes = np.array([code for _, code in given]).reshape(-1, outputs)
    return codes, int((ends - last).max()), int(np.diff(ends).max())


def rows(verilog: Path, tasks: Mapping[str, Task], folder: Path) -> Iterator[Row]:
    """The row of SERV with its memory.

    Raises
    ------
    InputError
        When a tool fails, or when a simulated frame has other outputs than ``model``.
    """
    task = tasks[MAIN]
    compiled(task, folder)
    for file in (*verilog.glob("*.v"), HERE / "serv_system.v"):
        shutil.copy(file, folder)
    outputs = model(task)
    found, clocks, interval = played(task.frames[:SIMULATED], outputs.shape[1], folder)
    agree("SERV", found, outputs[:SIMULATED])
    cells = in_one_piece(folder, "peer")
    yield Row(task.name, "SERV, program in C", cells, clocks, interval, task.errors(outputs))
