"""Tests the description of the machine, and the last lines of a run that show it."""

import os
import platform
import re
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

from tactus.core import machine
from tactus.verify.benches import tools

ROOT = Path(__file__).parents[1]
NAMES = ["processor", "instructions", "system", "versions", "took"]


def test_the_lines_name_what_is_here() -> None:
    lines = machine.closing(61.7, **tools.simulator_versions())
    assert [line.split()[0] for line in lines] == NAMES
    text = "\n".join(lines)
    assert platform.machine() in text
    assert f"{os.cpu_count()} core" in text
    for name in ("tactus", "numpy", "scipy", "myhdl", "cocotb"):
        assert f"{name} {version(name)}" in text
    assert f"python {platform.python_version()}" in text
    assert re.search(r"ghdl (\d+\.\d+\S*|none), icarus (\d+\.\d+\S*|none)$", text, re.M)
    assert re.search(r"^took +62 s$", text, re.M)


def test_a_processor_without_a_name_has_its_architecture(tmp_path: Path, monkeypatch) -> None:
    cpuinfo = tmp_path / "cpuinfo"
    cpuinfo.write_text("processor\t: 0\nCPU implementer\t: 0x41\n")
    monkeypatch.setattr(machine, "CPUINFO", cpuinfo)
    monkeypatch.setattr(platform, "processor", lambda: "")
    monkeypatch.setattr(platform, "machine", lambda: "aarch64")
    monkeypatch.setattr(os, "cpu_count", lambda: 1)
    assert machine.processor() == "aarch64, 1 core"
    cpuinfo.write_text("processor\t: 0\nmodel name\t: Some Processor: fast\n")
    assert machine.processor() == "Some Processor: fast, aarch64, 1 core"


def test_the_instructions_are_those_in_force() -> None:
    """These can be fewer instructions than the processor has."""
    command = [sys.executable, "-c", "from tactus.core.machine import *; print(facts())"]
    said = {}
    for threads in ("1", "2"):
        environment = os.environ | {"OPENBLAS_NUM_THREADS": threads, "OPENBLAS_CORETYPE": "Nehalem"}
        result = subprocess.run(
            command, cwd=ROOT, env=environment, capture_output=True, text=True, check=True
        )
        said[threads] = result.stdout
    assert "threads: 1" in said["1"]
    if (os.cpu_count() or 1) > 1:
        assert "threads: 2" in said["2"]
    if platform.machine() == "x86_64":
        assert "openblas Nehalem" in said["1"]
