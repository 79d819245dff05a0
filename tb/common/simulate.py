"""A bench in its simulator: cocotb-test builds an exported entity and runs cocotb inside."""

from __future__ import annotations

import logging
import os
import signal
import subprocess
import sys
import threading
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import cocotb_test.run
import cocotb_test.simulator
import find_libpython
from cocotb_tools import config

from golden.input_error import InputError

# Twice as fast as GHDL's default; where it is not installed, Debian's ghdl takes what is.
BACKEND = os.environ.get("GHDL_BACKEND", "llvm")
VHDL = "--std=93"
# Most of a simulation is numeric_std, which comes compiled: optimising what uses it takes longer
# than it saves.
QUICK = "-O0"
# Signals are undefined until reset; numeric_std warns of each at time 0.
QUIET_AT_0 = "--ieee-asserts=disable-at-0"
TIMESCALE = "1ns/1ps"


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
        raise InputError("no libpython: run: sudo apt-get install libpython3-dev")
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
    InputError
        With what GHDL says of a file.
    """
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
        raise InputError(result.stderr.strip())


# One simulator is set up at a time: each setup changes what the whole process shares.
SETTING_UP = threading.Lock()


@contextmanager
def process_unchanged() -> Iterator[None]:
    """Logging, warnings and signals stay as they are, which cocotb-test sets up for its own use.

    Meanwhile the environment lacks ``WAVES``, which cocotb-test takes for a number even where it is
    told whether to write waves.
    """
    log = logging.getLogger("cocotb")
    # logging.basicConfig adds nothing where a handler is.
    placeholder = logging.NullHandler()
    with SETTING_UP, warnings.catch_warnings():
        level = log.level
        handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
        logging.getLogger().addHandler(placeholder)
        waves = os.environ.pop("WAVES", None)
        try:
            yield
        finally:
            if waves is not None:
                os.environ["WAVES"] = waves
            logging.getLogger().removeHandler(placeholder)
            log.setLevel(level)
            if threading.current_thread() is threading.main_thread():
                for number, handler in handlers.items():
                    signal.signal(number, handler)


class BenchSimulator(cocotb_test.simulator.Simulator):
    """A simulator of cocotb-test that changes nothing outside of its run.

    Parameters
    ----------
    log : Path
        What the simulator prints is written there, and nothing to the terminal.
    **arguments
        Those of cocotb-test. ``extra_env`` is the whole environment of the run,
        but for what cocotb itself needs: nothing else is inherited.

    Raises
    ------
    SystemExit
        By ``run``, when it cannot be built, when it ends early, or when its tests did not pass.
    """

    def __init__(self, log: Path, **arguments: Any) -> None:
        with process_unchanged():
            super().__init__(**arguments)
        self.log = log

    @property
    def results(self) -> Path:
        """Where cocotb writes what became of each test."""
        return Path(self.work_dir) / "results.xml"

    def set_env(self) -> None:
        """Add to the given environment what cocotb needs."""
        self.env |= machine() | {
            "COCOTB_TOPLEVEL": self.toplevel_module,
            "COCOTB_TEST_MODULES": self.module,
            "COCOTB_RESULTS_FILE": str(self.results),
            "TOPLEVEL_LANG": self.toplevel_lang,
        }

    def execute(self, cmds: list[list[str]]) -> None:
        """Run one command after the other, up to the first that fails."""
        with self.log.open("w") as log:
            for command in cmds:
                ended = subprocess.run(
                    command,
                    cwd=self.work_dir,
                    env=self.env,
                    stdin=subprocess.DEVNULL,
                    stdout=log,
                    stderr=subprocess.STDOUT,
                    check=False,
                )
                if ended.returncode:
                    raise SystemExit(f"{command[0]} ended with {ended.returncode}: see {self.log}")

    def run(self) -> str:
        """Build and simulate; the results file."""
        self.set_env()
        self.execute(self.build_command())
        if not self.results.is_file() or not passed(self.results):
            raise SystemExit(f"{self.toplevel_module}: tests did not pass: see {self.log}")
        return str(self.results)


class Icarus(BenchSimulator, cocotb_test.simulator.Icarus):
    """Icarus, which compiles an entity from its own sources."""


class Ghdl(BenchSimulator, cocotb_test.simulator.Ghdl):
    """GHDL on a library that ``analyse`` has filled.

    Parameters
    ----------
    entity : str
        In that library.
    library : Path
    **arguments
        Those of ``BenchSimulator``, without sources.
    """

    def __init__(self, entity: str, library: Path, **arguments: Any) -> None:
        super().__init__(
            toplevel=f"work.{entity}",
            toplevel_lang="vhdl",
            # No list: cocotb-test would compile its files once more for each entity.
            vhdl_sources={},
            compile_args=[VHDL, f"--workdir={library}"],
            **arguments,
        )

    def build_command(self) -> list[list[str]]:
        """What links the entity, and what simulates it."""
        link = ["ghdl", "-e", *self.compile_args, self.toplevel_module]
        return [link, *super().build_command()]


SIMULATORS = {"ghdl": Ghdl, "icarus": Icarus}


def simulate(run: Run, environment: dict[str, str], log: Path) -> bool:
    """Build and simulate; whether every test of the bench ran and passed."""
    arguments = {
        "module": run.module,
        "sim_build": run.folder,
        "waves": run.waves,
        "extra_env": environment,
        "log": log,
    }
    if run.simulator == "ghdl":
        arguments |= {"entity": run.entity, "library": run.library, "sim_args": [QUIET_AT_0]}
    else:
        arguments |= {
            "toplevel": run.entity,
            "verilog_sources": list(run.sources),
            "timescale": TIMESCALE,
        }
    try:
        cocotb_test.run.run(simulator=SIMULATORS[run.simulator], **arguments)
    except SystemExit:
        return False
    return True


def passed(results: Path) -> bool:
    """Whether cocotb executed tests, skipped none, and none failed."""
    tests = list(ElementTree.parse(results).iter("testcase"))
    return bool(tests) and all(
        test.find(trouble) is None for test in tests for trouble in ("failure", "error", "skipped")
    )
