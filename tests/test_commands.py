"""Tests the commands as a user types them: what they list, refuse and write."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from shared import run

from tactus.cli.commands import WIDTH
from tactus.core.commands import CLOSING, COMMANDS
from tactus.scene import scene_names
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_mlp

ROOT = Path(__file__).parents[1]


def make(*words: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run make with the environment of this interpreter, so that nothing is installed."""
    environment.setdefault("MAKEFLAGS", "")
    return run("make", "--no-print-directory", f"VENV={sys.prefix}", *words, **environment)


def test_make_alone_lists_the_commands_before_anything_is_installed(tmp_path: Path) -> None:
    """It runs with a Python that only has its standard library, and without an environment."""
    python = tmp_path / "python3"
    python.write_text(f'#!/bin/sh\nexec "{sys.executable}" -E -S "$@"\n')
    python.chmod(0o755)
    result = make("PYTHON=python3", "VENV=none", PATH=f"{tmp_path}:{os.environ['PATH']}")
    assert result.returncode == 0, result.stderr
    assert not (ROOT / "none").exists()
    assert re.findall(r"^make ([a-z]+)", result.stdout, re.M) == [c.name for c in COMMANDS]
    told = " ".join(result.stdout.split())
    for command in COMMANDS:
        assert f"{command.usage} {command.purpose}" in told
    assert told.endswith(f"one of {', '.join(scene_names())}. {CLOSING}")
    assert max(map(len, result.stdout.splitlines())) <= WIDTH


@pytest.fixture(scope="module", autouse=True)
def ready() -> None:
    """Mark the present environment as ready, so that make does not set it up again."""
    (Path(sys.prefix) / ".ready").touch()


def test_a_missing_simulator_is_named_with_its_package(tmp_path: Path) -> None:
    for program in ("python", "bash", "env"):
        found = shutil.which(program)
        if found:
            (tmp_path / program).symlink_to(found)
    words = [
        sys.executable,
        "-m",
        "tactus.verify.sim",
        "digit-single",
        "--block",
        "hybrid",
        "--sim",
    ]
    for simulator, package in (("ghdl", "ghdl"), ("icarus", "iverilog")):
        result = run(*words, simulator, PATH=str(tmp_path))
        assert result.returncode == 2
        assert f"is not installed; on Debian: apt-get install {package}" in result.stderr


INSTALL = "env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends"


@pytest.mark.parametrize(
    ("user", "sudo", "done"),
    [
        (0, 1, ["apt-get update -q", f"{INSTALL} ghdl-llvm iverilog"]),
        (
            1000,
            0,
            ["sudo -n true", "sudo -n apt-get update -q", f"sudo -n {INSTALL} ghdl-llvm iverilog"],
        ),
        (1000, 1, ["sudo -n true"]),
    ],
)
def test_missing_tools_are_installed_or_named(tmp_path: Path, user: int, sudo: int, done) -> None:
    """They are installed as root or by a sudo without password.

    Other users get the command to run.
    """
    log = tmp_path / "log"
    # The output of apt-get is printed, because it takes a minute.
    for name, script in {
        "id": f"echo {user}",
        "sudo": f'echo "sudo $@" >> "{log}"; exit {sudo}',
        "apt-get": f'echo "apt-get $@" >> "{log}"',
        "env": f'echo "env $@" >> "{log}"; echo "Setting up ghdl-llvm"',
    }.items():
        (tmp_path / name).write_text(f"#!/bin/sh\n{script}\n")
        (tmp_path / name).chmod(0o755)
    program = shutil.which("make")
    result = run(program, "tools", PATH=str(tmp_path), MAKEFLAGS="")
    assert log.read_text().splitlines() == done
    if user and sudo:
        assert result.returncode == 2
        message = (
            "error: not installed: ghdl-llvm iverilog; run: sudo apt-get install ghdl-llvm iverilog"
        )
        assert message in result.stderr
    else:
        assert result.returncode == 0
        assert "installing ghdl-llvm iverilog" in result.stdout
        assert sudo == 0 or "Setting up ghdl-llvm" in result.stdout


def test_one_bench_by_its_command(tmp_path: Path) -> None:
    shape = (2, 3, 1)
    path = write_scene(tmp_path, "mine", "exact", [random_mlp(shape, 1.0, 1)])
    try:
        result = make("sim", "BLOCK=abs_unit", "SIM=icarus", f"SCENE={path}", "SEED=7", "WAVES=1")
        assert result.returncode == 0, result.stdout + result.stderr
        assert re.search(r"^pass +icarus +abs_unit +\d+ compared", result.stdout, re.M)
        assert re.search(r"1 benches, 0 failed, [1-9]\d+ results compared", result.stdout)
        wave = re.search(r"^waves: (.*\.fst)$", result.stdout, re.M)
        assert Path(wave[1]).stat().st_size > 0
    finally:
        shutil.rmtree(ROOT / "build" / "mine", ignore_errors=True)


def test_the_benchmark_reports_a_ratio() -> None:
    result = make("bench", "FRAMES=2000", "SCENE=digit-single")
    assert result.returncode == 0, result.stderr
    assert re.search(r"4:16:4 exact: 2000 frames, .* ratio \d+\.\d+; memory", result.stdout)


# A test of the second tier that takes less than a second.
LEFT = "tests/test_mutate.py::test_a_selection_that_yosys_takes_out_is_an_error"


def pytest_run(*words: str) -> subprocess.CompletedProcess[str]:
    without = {k: "" for k in os.environ if k.startswith("PYTEST")}
    return run(sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *words, **without)


def test_a_file_that_is_missing_is_named() -> None:
    result = pytest_run("test_schemes.py", "-n", "1")
    assert result.returncode == pytest.ExitCode.USAGE_ERROR
    assert "TESTS=test_schemes.py: no such file or folder; did you mean" in result.stderr


def test_the_summary_counts_what_is_left_and_a_choice_that_runs_nothing_fails() -> None:
    result = pytest_run(LEFT)
    assert "[1] tests/test_mutate.py" in result.stdout
    assert "left to make test ALL=1" in result.stdout
    assert result.returncode == pytest.ExitCode.NO_TESTS_COLLECTED
    assert "error: no test was chosen that could run" in result.stdout


def test_a_block_and_pages_are_selections_of_pytest() -> None:
    def chosen(*words: str) -> str:
        said = run(sys.executable, "tests/chosen.py", *words, DRY="1")
        return said.stdout + said.stderr

    assert "pytest -k comparator_bank and not test_site" in chosen("--block=comparator_bank")
    assert re.search(r"pytest -m pages .*tests/test_pages\.py", chosen("--pages"))
    assert "did you mean 'comparator_bank'" in chosen("--block=comparater_bank")
