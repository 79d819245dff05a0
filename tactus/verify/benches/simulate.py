"""Runs a bench in its simulator: builds an exported entity, and starts cocotb in it."""

import os
import subprocess
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import find_libpython
from cocotb_tools import config

from golden.input_error import InputError
from tactus.core.files import check_room

# This backend of GHDL is twice as fast as the default. Without it, Debian's ghdl takes another.
BACKEND = os.environ.get("GHDL_BACKEND", "llvm")
VHDL = "--std=93"
# A simulation spends most of its time in numeric_std, which is already compiled. Optimising the
# code that uses it takes longer than it saves.
QUICK = "-O0"
# Signals are undefined before the reset, and numeric_std would warn of each of them at time 0.
QUIET_AT_0 = "--ieee-asserts=disable-at-0"
TIMESCALE = "1ns/1ps"
WAVES = "module waves; initial begin $dumpfile({file}); $dumpvars(0, {entity}); end endmodule\n"
# Where cocotb writes what became of each test, in the folder of a run.
RESULTS = "results.xml"


@dataclass(frozen=True)
class Run:
    """One entity in one simulator.

    simulator, entity, module: ``module`` is that of the bench.
    sources: The files in compile order, for Icarus, which compiles every entity from its own
        sources.
    library: The library with all entities, for GHDL; ``analyse`` has filled it.
    folder: The folder of the build and the run.
    """

    simulator: str
    entity: str
    module: str
    sources: tuple[Path, ...]
    library: Path
    folder: Path
    waves: bool


@cache
def machine() -> dict[str, str]:
    """The variables by which cocotb finds this Python from inside a simulator."""
    python = find_libpython.find_libpython()
    if python is None:
        raise InputError("no libpython: run: sudo apt-get install libpython3-dev")
    return {
        "GPI_USERS": f"{python};{config.pygpi_entry_point()}",
        "PYGPI_PYTHON_BIN": sys.executable,
        "GHDL_BACKEND": BACKEND,
        # If pytest rewrote every module, that would take longer than most benches.
        "COCOTB_REWRITE_ASSERTION_FILES": "",
    }


def analyse(sources: Iterable[Path], library: Path) -> None:
    """Compile VHDL files once for all runs of their entities."""
    files = [str(source.resolve()) for source in sources]
    result = subprocess.run(
        ["ghdl", "-a", VHDL, QUICK, f"--workdir={library.resolve()}", *files],
        cwd=library,
        env=os.environ | {"GHDL_BACKEND": BACKEND},
        capture_output=True,
        text=True,
        check=False,
    )
    if result.returncode:
        check_room(library.parent, "the exported files")
        raise InputError(result.stderr.strip())


def commands(run: Run) -> list[list[str]]:
    """The commands that build an entity in the folder of a run, and simulate it."""
    vpi = str(config.lib_name_path("vpi", run.simulator))
    if run.simulator == "ghdl":
        analysed = [VHDL, f"--workdir={run.library}", run.entity]
        waves = [f"--wave={run.entity}.ghw"] if run.waves else []
        start = ["ghdl", "-r", *analysed, f"--vpi={vpi}", QUIET_AT_0, *waves]
        return [["ghdl", "-e", *analysed], start]
    (run.folder / "timescale.f").write_text(f"+timescale+{TIMESCALE}\n")
    build = ["iverilog", "-g2012", "-o", "run.vvp", "-f", "timescale.f", "-s", run.entity]
    build += map(str, run.sources)
    if run.waves:
        text = WAVES.format(file=f'"{run.entity}.fst"', entity=run.entity)
        (run.folder / "waves.v").write_text(text)
        build += ["-s", "waves", "waves.v"]
    return [build, ["vvp", "-m", vpi, "run.vvp", *(["-fst"] if run.waves else [])]]


def simulate(run: Run, environment: dict[str, str], log: Path) -> bool:
    """Build and simulate, and return whether every test of the bench ran and passed.

    ``environment`` and what cocotb itself needs are the whole environment of the run: nothing else
    is inherited. What the simulator prints goes to ``log``.
    """
    run.folder.mkdir(parents=True, exist_ok=True)
    results = run.folder / RESULTS
    needed = {
        "COCOTB_TOPLEVEL": run.entity,
        "COCOTB_TEST_MODULES": run.module,
        "COCOTB_RESULTS_FILE": str(results),
    }
    with log.open("w") as printed:
        for command in commands(run):
            ended = subprocess.run(
                command,
                cwd=run.folder,
                env=environment | machine() | needed,
                stdin=subprocess.DEVNULL,
                stdout=printed,
                stderr=subprocess.STDOUT,
                check=False,
            )
            if ended.returncode:
                return False
    return results.is_file() and passed(results)


def passed(results: Path) -> bool:
    """Whether cocotb executed tests, skipped none, and none failed."""
    tests = list(ElementTree.parse(results).iter("testcase"))
    return bool(tests) and all(
        test.find(trouble) is None for test in tests for trouble in ("failure", "error", "skipped")
    )
