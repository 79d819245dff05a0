"""A bench in its simulator: an exported entity is built, and cocotb runs inside."""

from __future__ import annotations

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

from golden.cli import CommandError

# Twice as fast as GHDL's default; where it is not installed, Debian's ghdl takes what is.
BACKEND = os.environ.get("GHDL_BACKEND", "llvm")
VHDL = "--std=93"
# Most of a simulation is numeric_std, which comes compiled: optimising what uses it takes longer
# than it saves.
QUICK = "-O0"


@dataclass(frozen=True)
class Run:
    """One entity in one simulator.

    Attributes
    ----------
    simulator, entity, module : str
        ``module`` is the bench.
    sources : tuple of Path
        In compile order; for Icarus, which builds every entity from its own.
    library : Path
        Where ``analyse`` has put all entities, for GHDL.
    folder : Path
        Where it is built and run.
    waves : bool
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
    """What cocotb needs to find this Python from inside a simulator."""
    python = find_libpython.find_libpython()
    if python is None:
        raise CommandError("no libpython: run: sudo apt-get install libpython3-dev")
    return {
        "GPI_USERS": f"{python};{config.pygpi_entry_point()}",
        "PYGPI_PYTHON_BIN": sys.executable,
        "GHDL_BACKEND": BACKEND,
        # pytest's rewriting of every module takes longer than most benches.
        "COCOTB_REWRITE_ASSERTION_FILES": "",
    }


def analyse(sources: Iterable[Path], library: Path) -> None:
    """Compile VHDL files once for all runs of their entities.

    Raises
    ------
    CommandError
        With what GHDL says of a file.
    """
    result = subprocess.run(
        ["ghdl", "-a", VHDL, QUICK, f"--workdir={library}", *map(str, sources)],
        cwd=library,
        env=os.environ | {"GHDL_BACKEND": BACKEND},
        capture_output=True,
        text=True,
        check=False,
    )
    if result.returncode:
        raise CommandError(result.stderr.strip())


def commands(run: Run) -> list[list[str]]:
    """What builds the entity, and what simulates it."""
    if run.simulator == "ghdl":
        unit = [VHDL, f"--workdir={run.library}", run.entity]
        waves = [f"--wave={run.entity}.ghw"] if run.waves else []
        # Signals are undefined until reset; numeric_std warns of each at time 0.
        options = [f"--vpi={config.lib_entry('vpi', 'ghdl')}", "--ieee-asserts=disable-at-0"]
        return [["ghdl", "-e", *unit], ["ghdl", "-r", *unit, *options, *waves]]
    built, settings = f"{run.entity}.vvp", run.folder / "settings.f"
    settings.write_text("+timescale+1ns/1ps\n")
    sources, tops = [str(path) for path in run.sources], [run.entity]
    if run.waves:
        waves_file = run.folder / "waves.v"
        waves_file.write_text(
            f'module waves(); initial begin $dumpfile("{run.entity}.fst"); '
            f"$dumpvars(0, {run.entity}); end endmodule\n"
        )
        sources.append(str(waves_file))
        tops.append("waves")
    units = [word for top in tops for word in ("-s", top)]
    return [
        ["iverilog", "-g2012", "-o", built, "-f", str(settings), *units, *sources],
        ["vvp", "-m", config.lib_entry("vpi", "icarus"), built, "-fst" if run.waves else "-none"],
    ]


def simulate(run: Run, environment: dict[str, str], log: Path) -> bool:
    """Build and simulate; whether every test of the bench ran and passed."""
    run.folder.mkdir(parents=True)
    results = run.folder / "results.xml"
    environment = environment | machine()
    environment |= {
        "COCOTB_TOPLEVEL": run.entity,
        "COCOTB_TEST_MODULES": run.module,
        "COCOTB_RESULTS_FILE": str(results),
        "TOPLEVEL_LANG": "vhdl" if run.simulator == "ghdl" else "verilog",
    }
    with log.open("w") as handle:
        for command in commands(run):
            ended = subprocess.run(
                command,
                cwd=run.folder,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=handle,
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
