"""Variables of make reach the command unchanged, whatever characters they hold."""

import re
import subprocess
import sys
from collections.abc import Iterator
from itertools import cycle
from pathlib import Path

import pytest
from conftest import ROOT
from shared import movable, run

from tactus.core.commands import COMMANDS
from tactus.scene import scene_path

# Each of these would make a file `ran` if make or the shell interpreted it.
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
CALLED = [command for command in COMMANDS if command.module]
# Variables that make or the shell test, and the paths of outputs.
FLAGS = {argument.name for c in COMMANDS for argument in c.arguments if argument.flag} | {"DRY"}
# All targets that take a flag and do no more here than log their calls.
TARGETS = [c.name for c in COMMANDS if any(a.flag for a in c.arguments)]
# This precedes the arguments of each call in the log.
CALL = "a call"


def environment(folder: Path, venv: str = "venv", instead: str = "") -> Path:
    """A virtual environment that seems ready, whose python only logs its arguments.

    Or it does what the text of a shell says, instead.

    For the arguments of ``tactus.cli.commands`` it does what the real one does.
    """
    python = folder / venv / "bin" / "python"
    python.parent.mkdir(parents=True)
    log = folder / "arguments"
    called = "import sys; sys.executable = sys.argv.pop(1); from tactus.core.cli import run; "
    called += "from tactus.cli.commands import main; sys.exit(run(main))"
    commands = f"""exec '{sys.executable}' -S -E -c '{called}' "$0" "$3" "$4\""""
    python.write_text(
        f"""#!/bin/sh
if [ "$2" = tactus.cli.commands ]; then {commands}; fi
{instead}
printf '%s\\0' '{CALL}' "$@" >> '{log}'
echo found
for last; do :; done
if [ "$2" = sphinx ]; then mkdir "$last"; fi
"""
    )
    python.chmod(0o755)
    (folder / venv / ".ready").touch()
    return log


def calls(log: Path) -> list[list[str]]:
    """The arguments of each logged call."""
    found: list[list[str]] = []
    for word in log.read_text().split("\0")[:-1]:
        if word == CALL:
            found.append([])
        else:
            found[-1].append(word)
    return found


def make(folder: Path, *words: str, **variables: str) -> subprocess.CompletedProcess[str]:
    command = ["make", "--no-print-directory", "-C", ROOT, *words]
    return run(*command, folder=folder, **variables)


@pytest.fixture(autouse=True)
def nothing_ran() -> Iterator[None]:
    yield
    assert not (ROOT / "ran").exists()


@pytest.mark.parametrize("first", [0, len(NASTY) // 2])
def test_an_argument_arrives_as_it_was_given(tmp_path: Path, first: int) -> None:
    """Each text is that of some arguments, all of which are handed on in the same way."""
    log = environment(tmp_path)
    texts = cycle([*NASTY[first:], *NASTY[:first]])
    chosen = [command for command in COMMANDS if command.arguments and command.name != "docs"]
    names = [command.name for command in chosen]
    given = {
        a.name: "1" if a.flag else f"{a.name}{next(texts)}{a.name}"
        for c in chosen
        for a in c.arguments
    }
    assert len(given) >= len(NASTY)
    words = [f"{name}={text}" for name, text in given.items()]
    result = make(tmp_path, f"VENV={tmp_path / 'venv'}", *names, *words)
    assert result.returncode == 0, result.stderr
    arrived = dict(zip(names, calls(log), strict=True))
    for command in CALLED:
        if command.arguments:
            _, module, *others = arrived[command.name]
            assert module == command.module
            for argument in command.arguments:
                arrives = (
                    argument.option if argument.flag else argument.option + given[argument.name]
                )
                assert others.count(arrives) == 1, f"{command.name}: {argument.name}"
            assert len(others) == len(command.arguments) + len(command.last)
    tests = f"--tests={given['TESTS']}"
    assert arrived["test"] == [
        "tests/chosen.py",
        f"--block={given['BLOCK']}",
        "--pages",
        tests,
        "--all",
    ]


@pytest.mark.parametrize("nasty", NASTY[::2])
def test_so_it_does_from_the_environment(tmp_path: Path, nasty: str) -> None:
    log, other = environment(tmp_path), NASTY[NASTY.index(nasty) + 1]
    names = ("monitor", "mutate")
    result = make(tmp_path, *names, VENV=str(tmp_path / "venv"), SCENE=nasty, PORT=other)
    assert result.returncode == 0, result.stderr
    assert [words[2:] for words in calls(log)] == [[nasty, other], [f"--scene={nasty}"]]


def test_a_scene_that_is_not_given_is_chosen(tmp_path: Path) -> None:
    """The table chooses the scene or, if it names none, the command does."""
    log = environment(tmp_path)
    names = ("listing", "sim", "vhdl", "monitor", "mutate", "demo")
    result = make(tmp_path, f"VENV={tmp_path / 'venv'}", *names, "PORT=twin")
    assert result.returncode == 0, result.stderr
    words = [call[2:] for call in calls(log)]
    assert words == [["digit"], [], ["vhdl"], ["digit-board", "twin"], [], []]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("train SCEN=mine.toml", r"SCEN=: make train takes .*; did you mean SCENE=\?"),
        ("train scene=mine.toml", r"scene=: make train takes .*; did you mean SCENE=\?"),
        ("check listing RECORD=1", "RECORD=: make check listing takes no such variable"),
        ("clean ALL=1", "ALL=: make clean takes no such variable, expected one of DRY,"),
        ("sim a`touch>ran`=1", "a`touch>ran`=: make sim takes no such variable"),
        ("sim DRY=no", "DRY=no: expected 1, or 0 or nothing"),
        ("demo FULL=2", "FULL=2: expected 1"),
        ("test ALL=maybe", "ALL=maybe: expected 1"),
        ("sim WAVES=`touch${IFS}ran`", "WAVES=.*: expected 1"),
    ],
)
def test_what_make_would_ignore_is_refused(tmp_path: Path, words: str, said: str) -> None:
    log = environment(tmp_path)
    result = make(tmp_path, f"VENV={tmp_path / 'venv'}", *words.split())
    assert result.returncode == 2
    assert re.match(f"error: {said}", result.stderr), result.stderr
    assert not log.exists()


def test_a_flag_of_the_environment_is_refused_and_a_variable_of_an_outer_make_is_not(
    tmp_path: Path,
) -> None:
    log = environment(tmp_path)
    venv = {"VENV": str(tmp_path / "venv")}
    assert "DRY=no: expected 1" in make(tmp_path, "clean", **venv, DRY="no").stderr
    result = make(tmp_path, "listing", **venv, MAKELEVEL="1", MAKEFLAGS=" -- OTHER=1")
    assert result.returncode == 0, result.stderr
    assert len(calls(log)) == 1


def test_but_0_and_nothing_is_none(tmp_path: Path) -> None:
    log = environment(tmp_path)
    options = {argument.option for c in COMMANDS for argument in c.arguments if argument.flag}
    words = [f"{name}={zero}" for name, zero in zip(sorted(FLAGS), cycle(["", "0"]))]
    folders = [f"VENV={tmp_path / 'venv'}", f"SITE={tmp_path / 'site'}"]
    result = make(tmp_path, *folders, *TARGETS, *words)
    assert result.returncode == 0, result.stderr
    assert not {word for call in calls(log) for word in call if word in options}


def test_make_s_own_commands_are_tried_too(tmp_path: Path) -> None:
    """With DRY=1 nothing is done, and clean removes nothing."""
    log = environment(tmp_path)
    words = [f"VENV={tmp_path / 'venv'}", f"SITE={tmp_path / 'site'}", "DRY=1"]
    result = make(tmp_path, *words, "docs", "pages", "lint", "clean")
    assert result.returncode == 0, result.stderr
    assert result.stdout.count("DRY=1: nothing done; would ") == 4
    assert not log.exists()
    assert (tmp_path / "venv").is_dir()
    assert not (tmp_path / "site").exists()


@pytest.mark.parametrize("nasty", [NASTY[2], NASTY[6] + NASTY[7] + NASTY[8], NASTY[-1]])
def test_so_do_paths(tmp_path: Path, nasty: str) -> None:
    """These are the paths of the environment, of the interpreter that makes it, and of the site."""
    log = environment(tmp_path, nasty)
    venv = tmp_path / nasty
    result = make(tmp_path, f"VENV={venv}", "listing")
    assert result.returncode == 0, result.stderr
    assert "tactus.cli.listing" in log.read_text()
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


@pytest.mark.parametrize(("target", "name"), [("docs", "SITE"), ("clean", "VENV")])
def test_a_folder_of_the_user_is_not_removed(tmp_path: Path, target: str, name: str) -> None:
    environment(tmp_path)
    own = tmp_path / "own"
    own.mkdir()
    (own / ".ready").touch()
    given = {"VENV": str(tmp_path / "venv")} | {name: str(own)}
    result = make(tmp_path, target, *(f"{key}={value}" for key, value in given.items()))
    assert result.returncode == 2
    assert f"error: {name}={own}: is there already, and has no " in result.stderr
    assert own.is_dir()


def test_a_quote_without_its_other_is_one_message(tmp_path: Path) -> None:
    (Path(sys.prefix) / ".ready").touch()
    for target, name in (("lean", "BESIDE"), ("test", "TESTS")):
        result = make(tmp_path, f"VENV={sys.prefix}", target, f"{name}=it's", PYTHONPATH=str(ROOT))
        assert result.returncode == 2
        assert f"error: {name}=it's: No closing quotation" in result.stderr


@pytest.mark.all_only
def test_the_benches_of_a_board_that_learns_are_green(tmp_path: Path) -> None:
    """Its only known output is the last one; those of the case learn-uart have three."""
    text = movable(scene_path("digit-load"))
    text = text.replace("clock_mhz = 64.0", 'clock_mhz = 25.0\nlearning = "lms"')
    own = tmp_path / "learns.toml"
    own.write_text(f'{text}\n[front_end]\nconverter = "mcp3208"\n\n[uart]\nbaud = 1_000_000\n')
    for block in ("readout", "lesson_receiver", "packet_sender", "uart_instrument"):
        words = ["sim", f"SCENE={own}", f"BLOCK={block}", "SIM=icarus"]
        said = make(ROOT, "-o", "ready", f"VENV={sys.prefix}", *words)
        assert said.returncode == 0, said.stdout + said.stderr
        assert "1 benches, 0 failed" in said.stdout
