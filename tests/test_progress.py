"""Tests progress, which is shown as lines in a file, and as one line on a terminal."""

import io
import re
import subprocess
import sys
import threading
import time
from contextlib import ExitStack
from pathlib import Path

import pytest

from tactus.cli import set_up
from tactus.core import progress as module
from tactus.core.progress import PAUSE, Progress, stage


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


class Clock:
    """A clock that stands still until a test moves it."""

    now = 100.0

    def __call__(self) -> float:
        return self.now


def test_a_line_at_the_beginning_every_few_seconds_and_at_the_end() -> None:
    stream, clock = io.StringIO(), Clock()
    with Progress("digit: simulating", 4, "benches", stream, clock) as progress:
        clock.now += PAUSE - 1
        progress.step()
        clock.now += 2
        progress.step("best 3")
        progress.say("FAIL")
        progress.step()
        clock.now += 1
        progress.step()
    assert stream.getvalue().splitlines() == [
        "digit: simulating: 0 of 4 benches",
        "digit: simulating: 2 of 4 benches, about 5 s left, best 3",
        "FAIL",
        "digit: simulating: 4 of 4 benches in 6 s",
    ]


def test_what_is_left_counts_how_long_parts_take_and_what_follows() -> None:
    """A part that takes three times as long as the second is left, and a job of four such parts.

    Processes start while the first part is done.
    """
    stream, clock = io.StringIO(), Clock()
    with Progress("load", 3, "parts", stream, clock, costs=[1, 1, 3], behind=12) as progress:
        for seconds in (10 * PAUSE, PAUSE, 3 * PAUSE):
            clock.now += seconds
            progress.step()
    assert stream.getvalue().splitlines() == [
        "load: 0 of 3 parts",
        "load: 1 of 3 parts, 40 s",
        "load: 2 of 3 parts, about 12 s left, 60 s with what follows",
        "load: 3 of 3 parts in 56 s",
    ]


def test_a_terminal_shows_one_line() -> None:
    stream, clock = Terminal(), Clock()
    with Progress("a", 2, "parts", stream, clock) as progress:
        for _ in range(2):
            clock.now += 1
            progress.step()
    shown = stream.getvalue()
    assert shown.count("\n") == 1
    assert shown.split("\r\x1b[K")[1:] == [
        "a: 0 of 2 parts",
        "a: 1 of 2 parts, about 1 s left",
        "a: 2 of 2 parts in 2 s\n",
    ]


def test_of_parts_that_differ_nothing_is_estimated_and_each_is_named() -> None:
    stream, clock = io.StringIO(), Clock()
    with Progress("digit on a board", 2, "steps", stream, clock, alike=False) as progress:
        with progress.running("export"):
            clock.now += 1
        progress.step()
        for name in ("synthesis", "packing"):
            with progress.running(name):
                clock.now += 100
        progress.step("packed")
    assert stream.getvalue().splitlines() == [
        "digit on a board: 0 of 2 steps",
        "digit on a board: 0 of 2 steps, running export",
        "digit on a board: 1 of 2 steps, 1 s, running synthesis",
        "digit on a board: 1 of 2 steps, 2 min, running packing",
        "digit on a board: 2 of 2 steps in 3 min, packed",
    ]


def waited_for(stream: io.StringIO, pattern: str) -> None:
    """Wait until the stream has such a line. A minute is much longer than it takes."""
    end = time.monotonic() + 60
    while not re.search(pattern, stream.getvalue(), re.M):
        assert time.monotonic() < end, stream.getvalue()
        time.sleep(0.01)


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "PAUSE", 0.05)
    monkeypatch.setattr(module, "BEAT", 0.01)


def test_what_runs_is_named_while_nothing_ends(quick: None) -> None:
    stream = io.StringIO()
    with Progress("simulating", 5, "benches", stream) as progress:
        names = ["engine", "top", "a"]
        with ExitStack() as stack:
            for name in names:
                stack.enter_context(progress.running(name))
            waited_for(stream, r"^simulating: 0 of 5 benches, running engine, top, a$")
            stack.enter_context(progress.running("b"))
            waited_for(stream, r", running engine, top, a and 1 more$")
    assert not [thread for thread in threading.enumerate() if thread.name == "progress"]


def test_a_stage_says_that_it_is_still_there(quick: None) -> None:
    stream = io.StringIO()
    with stage("digit: exporting", stream):
        waited_for(stream, r"\Adigit: exporting\n(digit: exporting, 0 s\n)")
    ended = stream.getvalue()
    time.sleep(0.2)
    assert stream.getvalue() == ended


@pytest.mark.parametrize("fault", ["", "venv", "pip"])
def test_setting_up_prints_what_pip_does(tmp_path: Path, monkeypatch, capfd, fault: str) -> None:
    """The Python of this test installs nothing, but prints messages."""
    python = tmp_path / "python"
    python.write_text(
        f"""#!/bin/sh
[ "$2" = "{fault}" ] && exit 3
if [ "$2" = venv ]; then mkdir -p "$4/bin"; cp "$0" "$4/bin/python"; fi
if [ "$2" = pip ]; then echo "Collecting numpy ($*)"; fi
"""
    )
    python.chmod(0o755)
    venv = tmp_path / "my env"
    monkeypatch.setattr(sys, "executable", str(python))
    monkeypatch.setattr(sys, "argv", ["set_up", str(venv)])
    assert set_up.main() == (3 if fault else 0)
    said = capfd.readouterr().out
    assert said.startswith(f"setting up {venv}\n")
    if not fault:
        assert f"installing into {venv} what pyproject.toml names\nCollecting numpy (" in said
        assert "--quiet" not in said
        assert said.endswith("-e .[dev])\n")


def test_setting_up_needs_nothing_that_is_not_there_yet() -> None:
    """A Python that only has its standard library can import it."""
    root = Path(__file__).parents[1]
    words = [sys.executable, "-S", "-E", "-c", "import tactus.cli.set_up"]
    subprocess.run(words, cwd=root, check=True)
