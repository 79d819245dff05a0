"""Runs a bench in its simulator: builds an exported entity and starts cocotb in it."""

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


def surroundings(
    environment: dict[str, str], entity: str, module: str, language: str, results: Path
) -> dict[str, str]:
    """The given environment, with the variables by which cocotb finds the bench in ``module``.

    results: The file in which cocotb writes the result of each test.
    """
    return environment | {
        **machine(),
        "COCOTB_TOPLEVEL": entity,
        "COCOTB_TEST_MODULES": module,
        "COCOTB_RESULTS_FILE": str(results),
        "TOPLEVEL_LANG": language,
    }


def ghdl_commands(entity: str, library: Path, *options: str) -> list[list[str]]:
    """The commands that link an entity of a library that ``analyse`` has filled, and simulate it.

    *options: Those of the simulation.
    """
    of = [VHDL, f"--workdir={library}", entity]
    return [
        ["ghdl", "-e", *of],
        ["ghdl", "-r", *of, f"--vpi={config.lib_name_path('vpi', 'ghdl')}", *options],
    ]


def _icarus_commands(run: Run) -> list[list[str]]:
    """The commands that compile an entity from its own sources, and simulate it."""
    timescale = run.folder / "timescale.f"
    timescale.write_text(f"+timescale+{TIMESCALE}\n", encoding="ascii")
    built = str(run.folder / f"{run.entity}.vvp")
    compiles = ["iverilog", "-g2012", "-o", built, "-s", run.entity, "-f", str(timescale)]
    simulates = ["vvp", "-m", str(config.lib_name_path("vpi", "icarus")), built]
    if run.waves:
        dump = run.folder / "dump.v"
        dump.write_text(
            f'module dump; initial begin $dumpfile("{run.entity}.fst"); '
            f"$dumpvars(0, {run.entity}); end endmodule\n",
            encoding="ascii",
        )
        compiles += ["-s", "dump", str(dump)]
        simulates += ["-fst"]
    return [[*compiles, *map(str, run.sources)], simulates]


def simulate(run: Run, environment: dict[str, str], log: Path) -> bool:
    """Build and simulate, and return whether every test of the bench ran and passed.

    environment: With what cocotb needs, it is the whole environment: nothing is inherited.
    log: The file for what the simulator prints. Nothing goes to the terminal.
    """
    run.folder.mkdir(parents=True, exist_ok=True)
    if run.simulator == "ghdl":
        waves = [f"--wave={run.entity}.ghw"] if run.waves else []
        commands, language = ghdl_commands(run.entity, run.library, *waves, QUIET_AT_0), "vhdl"
    else:
        commands, language = _icarus_commands(run), "verilog"
    results = run.folder / RESULTS
    variables = surroundings(environment, run.entity, run.module, language, results)
    with log.open("w") as output:
        for command in commands:
            ended = subprocess.run(
                command,
                cwd=run.folder,
                env=variables,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                check=False,
            )
            if ended.returncode:
                return False
    return results.is_file() and passed(results)


def simulated_time(results: Path) -> dict[str, float]:
    """How long each executed test of a bench was, in nanoseconds of the simulation."""
    return {
        test.attrib["name"]: float(given.attrib["value"])
        for test in ElementTree.parse(results).iter("testcase")
        for given in test.iter("property")
        if given.attrib["name"] == "sim_time_duration"
    }


def passed(results: Path) -> bool:
    """Whether cocotb executed tests, skipped none, and none failed."""
    tests = list(ElementTree.parse(results).iter("testcase"))
    return bool(tests) and all(
        test.find(trouble) is None for test in tests for trouble in ("failure", "error", "skipped")
    )
