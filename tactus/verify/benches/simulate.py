"""Runs a bench in its simulator: cocotb-test builds an exported entity and starts cocotb in it."""

import logging
import os
import signal
import subprocess
import sys
import threading
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import cocotb_test.run
import cocotb_test.simulator
import find_libpython
from cocotb_tools import config

from golden.input_error import InputError

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
        raise InputError(result.stderr.strip())


# Only one simulator is set up at a time, because each setup changes settings of the process.
SETTING_UP = threading.Lock()


@contextmanager
def process_unchanged() -> Iterator[None]:
    """Restore the logging, warnings and signal handlers that cocotb-test changes for its own use.

    In the meantime ``WAVES`` is not in the environment, because cocotb-test reads it as a number
    even if it has been told whether to write waves.
    """
    log = logging.getLogger("cocotb")
    # logging.basicConfig adds no handler if there is one.
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

    log: The file for what the simulator prints. Nothing goes to the terminal.
    **arguments: The arguments of cocotb-test. ``extra_env`` and what cocotb itself needs are the
        whole environment of the run: nothing else is inherited.
    """

    def __init__(self, log: Path, **arguments: Any) -> None:
        with process_unchanged():
            super().__init__(**arguments)
        self.log = log

    def run(self) -> None:
        """Build and simulate, and stop where a command fails or a test did not run and pass."""
        results = Path(self.work_dir) / RESULTS
        self.env |= machine() | {
            "COCOTB_TOPLEVEL": self.toplevel_module,
            "COCOTB_TEST_MODULES": self.module,
            "COCOTB_RESULTS_FILE": str(results),
            "TOPLEVEL_LANG": self.toplevel_lang,
        }
        with self.log.open("w") as log:
            for command in self.build_command():
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
        if not results.is_file() or not passed(results):
            raise SystemExit(f"{self.toplevel_module}: tests did not pass: see {self.log}")


class Icarus(BenchSimulator, cocotb_test.simulator.Icarus):
    """Icarus, which compiles an entity from its own sources."""


class Ghdl(BenchSimulator, cocotb_test.simulator.Ghdl):
    """GHDL, which takes an entity from a library that ``analyse`` has filled."""

    def build_command(self) -> list[list[str]]:
        link = ["ghdl", "-e", *self.compile_args, self.toplevel_module]
        return [link, *super().build_command()]


def simulate(
    simulator: str,
    entity: str,
    module: str,
    sources: Iterable[Path],
    library: Path,
    folder: Path,
    waves: bool,
    environment: dict[str, str],
    log: Path,
) -> bool:
    """Build and simulate an entity, and return whether every test of its bench ran and passed.

    module: The bench.
    sources: The files in compile order, for Icarus, which compiles every entity from its own
        sources.
    library: The library with all entities, for GHDL; ``analyse`` has filled it.
    folder: The folder of the build and the run.
    """
    arguments: dict[str, Any] = {
        "module": module,
        "sim_build": folder,
        "waves": waves,
        "extra_env": environment,
        "log": log,
    }
    if simulator == "ghdl":
        arguments |= {
            "simulator": Ghdl,
            "toplevel": f"work.{entity}",
            "toplevel_lang": "vhdl",
            # The list is empty, because cocotb-test would compile the files again for each entity.
            "vhdl_sources": {},
            "compile_args": [VHDL, f"--workdir={library}"],
            "sim_args": [QUIET_AT_0],
        }
    else:
        arguments |= {
            "simulator": Icarus,
            "toplevel": entity,
            "verilog_sources": list(sources),
            "timescale": TIMESCALE,
        }
    try:
        cocotb_test.run.run(**arguments)
    except SystemExit:
        return False
    return True


def passed(results: Path) -> bool:
    """Whether cocotb executed tests, skipped none, and none failed."""
    tests = list(ElementTree.parse(results).iter("testcase"))
    return bool(tests) and all(
        test.find(trouble) is None for test in tests for trouble in ("failure", "error", "skipped")
    )
