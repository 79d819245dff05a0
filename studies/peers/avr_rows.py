"""A microcontroller: compiles the network for an ATmega328P and measures its clocks in simavr."""

from collections.abc import Iterator, Mapping
from pathlib import Path

from golden.input_error import InputError
from golden.numbers.fixed import Codes
from studies.peers.comparison import MAIN, Row, Task
from studies.peers.installed import run
from studies.peers.program import HERE, SOURCE, model, timed, written
from studies.peers.simulated import assert_equal_outputs

NAME = "ATmega328P"
PACKAGES = "gcc-avr avr-libc gcc libc6-dev libsimavr-dev libelf-dev"
COMPILER = ["avr-gcc", f"-mmcu={NAME.lower()}", "-O2"]
SIMULATOR = "simulate"


def download(folder: Path) -> Path:
    """The simulator, which is simavr with ``avr_bench.c``, compiled into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    bench = str(HERE / "avr_bench.c")
    try:
        run([*COMPILER, "-include", "avr/io.h", "-E", "-x", "c", "/dev/null"])
        run(["cc", "-O2", "-o", SIMULATOR, bench, "-lsimavr", "-lelf"], folder)
    except InputError as error:
        raise InputError(f"{error}; apt-get install {PACKAGES}") from None
    return folder / SIMULATOR


def compiled(task: Task, folder: Path) -> tuple[int, int]:
    """Write ``program``; the bytes of flash, and those of RAM without the stack."""
    written(task, "avr_platform.h", folder)
    run([*COMPILER, "-o", "program", SOURCE], folder)
    sizes = run(["avr-size", "program"], folder).splitlines()[1].split()
    text, data, bss = (int(size) for size in sizes[:3])
    return text + data, data + bss


def played(
    simulator: Path, frames: Codes, outputs: int, folder: Path
) -> tuple[tuple[Codes, int, int], int]:
    """What ``timed`` says of frames in the simulator, and the most bytes of the stack."""
    samples = [str(code) for code in frames.ravel().tolist()]
    results = str(len(frames) * outputs)
    program = str(folder / "program")
    printed = run([str(simulator), NAME.lower(), program, results, *samples])
    (stack,) = (line.split()[1] for line in printed.splitlines() if line.startswith("stack "))
    return timed(printed, frames.shape[1], outputs), int(stack)


def rows(simulator: Path, tasks: Mapping[str, Task], folder: Path) -> Iterator[Row]:
    """The row of the microcontroller, which has no cells of an FPGA."""
    task = tasks[MAIN]
    flash, ram = compiled(task, folder)
    outputs = model(task)
    measured, stack = played(simulator, task.frames, outputs.shape[1], folder)
    found, clocks, interval = measured
    assert_equal_outputs(NAME, found, outputs)
    name = f"{NAME}, program in C, {flash} bytes of flash and {ram + stack} of RAM"
    yield Row(task.name, name, None, clocks, interval, task.errors(outputs))
