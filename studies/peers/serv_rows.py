"""SERV: compiles the network for this bit-serial RISC-V, measures its clocks, counts the cells."""

import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from golden.input_error import InputError
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from studies.peers.cells import in_one_piece
from studies.peers.comparison import MAIN, Row, Task
from studies.peers.installed import installed, run
from studies.peers.program import HERE, SOURCE, model, timed, written
from studies.peers.simulated import assert_equal_outputs

PACKAGE = "pythondata-cpu-serv"
TOOLS = "riscv64-unknown-elf"
OPTIONS = ["-march=rv32i", "-mabi=ilp32", "-O2", "-ffreestanding", "-nostdlib"]
# Bytes of the memory for program and data.
MEMORY = 16384
# The frames that are simulated.
SIMULATED = 4


def download(folder: Path) -> Path:
    """The folder with SERV's Verilog, in an environment with its package; see ``installed``."""
    try:
        run([f"{TOOLS}-gcc", "--version"])
    except InputError as error:
        raise InputError(f"{error}; apt-get install gcc-{TOOLS}") from None
    installed(folder, PACKAGE)
    (verilog,) = folder.glob("lib/*/site-packages/pythondata_cpu_serv/verilog/rtl")
    return verilog


def compiled(task: Task, folder: Path) -> None:
    """Write ``program.mem``, the words of the memory."""
    written(task, "serv_platform.h", folder)
    # The first instruction is at address 0.
    places = ["-Wl,--section-start=.start=0,-Ttext=0x10,--entry=start", f"-DMEMORY={MEMORY}"]
    run([f"{TOOLS}-gcc", *OPTIONS, *places, "-o", "program", SOURCE, "-lgcc"], folder)
    run([f"{TOOLS}-objcopy", "-O", "binary", "program", "program.bin"], folder)
    found = (folder / "program.bin").read_bytes()
    if len(found) > MEMORY:
        raise InputError(f"SERV: the program takes {len(found)} bytes, expected {MEMORY} at most")
    words = np.frombuffer(found.ljust(MEMORY, b"\0"), "<u4")
    (folder / "program.mem").write_text("".join(f"{word:08x}\n" for word in words))


def played(frames: Codes, outputs: int, folder: Path) -> tuple[Codes, int, int]:
    """The outputs of frames in Icarus, and the clocks of ``timed``."""
    mask = (1 << SIGNAL.width) - 1
    samples = [f"{code & mask:x}\n" for code in frames.ravel().tolist()]
    (folder / "samples.hex").write_text("".join(samples), encoding="utf-8")
    sizes = [f"-Pplay.SAMPLES={frames.size}", f"-Pplay.RESULTS={len(frames) * outputs}"]
    sources = [*sorted(file.name for file in folder.glob("*.v")), str(HERE / "serv_bench.v")]
    run(["iverilog", "-g2012", "-s", "play", *sizes, "-o", "play.vvp", *sources], folder)
    return timed(run(["vvp", "-n", "play.vvp"], folder), frames.shape[1], outputs)


def rows(verilog: Path, tasks: Mapping[str, Task], folder: Path) -> Iterator[Row]:
    """The row of SERV with its memory."""
    task = tasks[MAIN]
    compiled(task, folder)
    for file in (*verilog.glob("*.v"), HERE / "serv_system.v"):
        shutil.copy(file, folder)
    outputs = model(task)
    found, clocks, interval = played(task.frames[:SIMULATED], outputs.shape[1], folder)
    assert_equal_outputs("SERV", found, outputs[:SIMULATED])
    cells = in_one_piece(folder, "peer")
    yield Row(task.name, "SERV, program in C", cells, clocks, interval, task.errors(outputs))
