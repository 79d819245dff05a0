"""What a user gives to make reaches the command as it is: no character of it is special."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")
GIVEN = re.sub(r"\\\n", "", MAKEFILE).partition("GIVEN := ")[2].splitlines()[0].split()
RECIPES = [line for line in re.sub(r"\\\n", "", MAKEFILE).splitlines() if line.startswith("\t")]

# Each would leave a file `ran` behind, were it read by make or by the shell.
NASTY = [
    "`touch ran`",
    "$(touch ran)",
    "$(shell touch ran)",
    "${shell touch ran}",
    "$$(touch ran)",
    "; touch ran #",
    "a\ntouch ran\n",
    '"; touch ran; "',
    "'; touch ran; '",
    "\\\"; touch ran; \\'",
    "| touch ran",
    "& touch ran &",
    "> ran",
    "$HOME %, (a) {b,c} [d] * ? ! ~ # = : @ é \t",
]
# The variables that are arguments of a command, an option or a word of it, and of which commands.
ARGUMENTS = {
    "SCENE": (
        "",
        "demo sim vhdl verilog check train recalibrate predict network image monitor record "
        "load bench listing lean synth bitstream report",
    ),
    "BOARD": ("", "bitstream"),
    "DEVICE": ("--device=", "bitstream"),
    "BLOCK": ("--block=", "sim mutate prove coverage"),
    "SIM": ("--sim=", "sim"),
    "NETLIST": ("--netlist=", "sim"),
    "SEED": ("--seed=", "sim figures peers"),
    "FRAMES": ("--frames=", "sim record bench"),
    "CLUSTER": ("--cluster=", "train"),
    "CSV": ("", "scene recalibrate predict"),
    "OUTPUTS": ("", "scene"),
    "TO": ("", "recalibrate predict network record"),
    "OUTPUT": ("--output=", "network"),
    "HARDWARE": ("--hardware=", "scene image monitor load"),
    "PORT": ("", "monitor record load"),
    "BAUD": ("--baud=", "monitor record load"),
    "LABELS": ("--labels=", "record"),
    "TABLE": ("", "figures"),
    "RIG": ("", "sensors"),
    "BESIDE": ("--beside=", "lean"),
    "TESTS": ("--tests=", "test machines"),
    "MACHINE": ("", "test"),
    "ONLY": ("", "machines"),
}
# What make or the shell ask about, and paths of what is made.
OTHERS = {"ALL", "FULL", "LINKS", "RECORD", "WAVES", "WHOLE", "PYTHON", "SITE", "VENV"}


def environment(folder: Path, venv: str = "venv") -> Path:
    """A virtual environment that is ready, whose python only writes down its arguments."""
    python = folder / venv / "bin" / "python"
    python.parent.mkdir(parents=True)
    log = folder / "arguments"
    python.write_text(
        f"""#!/bin/sh
printf '%s\\0' "$@" >> '{log}'
echo found
for last; do :; done
if [ "$2" = sphinx ]; then mkdir "$last"; fi
"""
    )
    python.chmod(0o755)
    (folder / venv / ".ready").touch()
    return log


def make(folder: Path, *words: str, **variables: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["make", "--no-print-directory", "-C", str(ROOT), *words],
        cwd=folder,
        env={k: v for k, v in os.environ.items() if k not in GIVEN} | {"MAKEFLAGS": ""} | variables,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture(autouse=True)
def nothing_ran() -> Iterator[None]:
    yield
    assert not (ROOT / "ran").exists()


@pytest.mark.parametrize("nasty", NASTY)
def test_an_argument_arrives_as_it_was_given(tmp_path: Path, nasty: str) -> None:
    log = environment(tmp_path)
    given = {name: f"{name}{nasty}{name}" for name in ARGUMENTS}
    targets = dict.fromkeys(target for _, names in ARGUMENTS.values() for target in names.split())
    words = [f"{name}={text}" for name, text in given.items()]
    result = make(tmp_path, f"VENV={tmp_path / 'venv'}", *targets, *words)
    assert result.returncode == 0, result.stderr
    arrived = log.read_text().split("\0")
    for name, (option, names) in ARGUMENTS.items():
        assert arrived.count(f"{option}{given[name]}") == len(names.split()), name


@pytest.mark.parametrize("nasty", NASTY)
def test_so_it_does_from_the_environment(tmp_path: Path, nasty: str) -> None:
    log = environment(tmp_path)
    result = make(tmp_path, "listing", VENV=str(tmp_path / "venv"), SCENE=nasty)
    assert result.returncode == 0, result.stderr
    assert nasty in log.read_text().split("\0")


@pytest.mark.parametrize("nasty", NASTY)
def test_so_does_a_flag_and_the_help(tmp_path: Path, nasty: str) -> None:
    log = environment(tmp_path)
    words = [f"{name}={nasty}" for name in ("ALL", "LINKS", "RECORD", "WAVES", "WHOLE")]
    targets = ("help", "test", "machines", "sim", "synth")
    result = make(tmp_path, f"VENV={tmp_path / 'venv'}", *targets, *words, f"SCENE={nasty}")
    assert result.returncode == 0, result.stderr
    assert f"now {nasty}\n" in result.stdout
    assert {"--all", "--whole", "--waves", "--record"} <= set(log.read_text().split("\0"))


@pytest.mark.parametrize("nasty", [text for text in NASTY if "/" not in text])
def test_so_do_paths(tmp_path: Path, nasty: str) -> None:
    """Of the environment, of the interpreter that makes it, and of the site."""
    log = environment(tmp_path, nasty)
    venv = tmp_path / nasty
    result = make(tmp_path, f"VENV={venv}", "listing")
    assert result.returncode == 0, result.stderr
    assert "golden.engine" in log.read_text()
    (venv / ".ready").unlink()
    python = venv / "bin" / "python"
    result = make(tmp_path, f"VENV={venv}", f"PYTHON={python}", "ready")
    assert result.returncode == 0, result.stderr
    assert log.read_text().split("\0").count(str(venv)) == 1
    assert (venv / ".ready").exists()
    site = tmp_path / f"site{nasty}"
    result = make(tmp_path, f"VENV={venv}", "docs", f"SITE={site}")
    assert result.returncode == 0, result.stderr
    assert site.is_dir()
    assert make(tmp_path, f"VENV={venv}", "clean", "-n").returncode == 0


def test_recipes_have_no_text_of_a_user() -> None:
    """Make puts in none of what is given: it only asks whether there is any."""
    assert set(ARGUMENTS) | OTHERS == set(GIVEN)
    for line in RECIPES:
        for name in re.findall(r"\$[({](\w+)", line):
            if name in GIVEN:
                once = rf"\$\((if |filter-out 0,)\$\({name}\)"
                assert len(re.findall(once, line)) == line.count(f"$({name})"), line


def test_a_quote_without_its_other_is_one_message(tmp_path: Path) -> None:
    (Path(sys.prefix) / ".ready").touch()
    for target, name in (("lean", "BESIDE"), ("test", "TESTS"), ("machines", "ONLY")):
        result = make(tmp_path, f"VENV={sys.prefix}", target, f"{name}=it's", PYTHONPATH=str(ROOT))
        assert result.returncode == 2
        assert f"error: {name}=it's: No closing quotation" in result.stderr
