"""Files and folders are replaced as a whole, with the permissions that the umask allows."""

import io
import os
import re
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

from golden.input_error import InputError
from tactus.cli import set_up
from tactus.core import progress as module
from tactus.core.files import check_writable, replace_file, replace_files, replace_folder, same_file
from tactus.core.progress import PAUSE, Progress, stage


@contextmanager
def umask(mask: int) -> Iterator[None]:
    before = os.umask(mask)
    try:
        yield
    finally:
        os.umask(before)


@pytest.mark.parametrize(("mask", "file", "folder"), [(0o022, 0o644, 0o755), (0o077, 0o600, 0o700)])
def test_permissions_are_those_of_the_umask(
    tmp_path: Path, mask: int, file: int, folder: int
) -> None:
    with umask(mask):
        for _ in range(2):  # new, and in place of another
            with replace_file(tmp_path / "a.csv") as path:
                path.write_text("1\n", encoding="utf-8")
            with replace_folder(tmp_path / "b") as path:
                (path / "c.csv").write_text("1\n", encoding="utf-8")
            assert (tmp_path / "a.csv").stat().st_mode & 0o777 == file
            assert (tmp_path / "b").stat().st_mode & 0o777 == folder
            assert (tmp_path / "b" / "c.csv").stat().st_mode & 0o777 == file
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.csv", "b"]


def half(replace: Callable, target: Path, file: str) -> None:
    with replace(target) as path:
        (path / file).write_text("new", encoding="utf-8")
        raise InputError("half")


def test_a_failure_leaves_what_was(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("old", encoding="utf-8")
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "c.csv").write_text("old", encoding="utf-8")
    for replace, target, file in ((replace_file, "a.csv", ""), (replace_folder, "b", "c.csv")):
        with pytest.raises(InputError, match="half"):
            half(replace, tmp_path / target, file)
        assert (tmp_path / target / file).read_text(encoding="utf-8") == "old"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.csv", "b"]


def test_several_files_are_replaced_or_none(tmp_path: Path) -> None:
    """This holds even if the fault only shows when the last file is renamed."""
    paths = [tmp_path / "new.csv", tmp_path / "old.csv", tmp_path / "last.csv"]
    paths[1].write_text("old", encoding="utf-8")

    def replace(fault: Callable[[], object]) -> None:
        with replace_files(paths) as temporaries:
            for temporary in temporaries:
                temporary.write_text("new", encoding="utf-8")
            fault()

    with pytest.raises(InputError, match=r"last.csv: cannot be written: Is a directory"):
        replace(paths[2].mkdir)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["last.csv", "old.csv"]
    assert paths[1].read_text(encoding="utf-8") == "old"
    paths[2].rmdir()
    replace(lambda: None)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["last.csv", "new.csv", "old.csv"]
    assert {path.read_text(encoding="utf-8") for path in paths} == {"new"}


def test_what_can_be_written_is_found_out_without_writing(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("old", encoding="utf-8")
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "to-pipe").symlink_to("pipe")
    for name in ("pipe", "to-pipe"):
        with pytest.raises(InputError, match="cannot be written: got no regular file"):
            check_writable([tmp_path / name])
        with pytest.raises(InputError, match="got no reg"), replace_file(tmp_path / name):
            pass
    assert (tmp_path / "to-pipe").is_fifo()
    (tmp_path / "to-pipe").unlink()
    (tmp_path / "pipe").unlink()
    check_writable([tmp_path / "a.csv", tmp_path / "b" / "c" / "d.csv"])
    assert [p.name for p in tmp_path.iterdir()] == ["a.csv"]
    for name in ("a.csv/b.csv", ".", "x" * 5000, "b/\0"):
        with pytest.raises(InputError, match="cannot be written: "):
            check_writable([tmp_path / name])
    assert [p.name for p in tmp_path.iterdir()] == ["a.csv"]


def test_one_file_by_two_names(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a").touch()
    (tmp_path / "link").symlink_to("a")
    (tmp_path / "later").symlink_to("not-yet")
    (tmp_path / "hard").hardlink_to(tmp_path / "a")
    for one, other in (("a", "b/../a"), ("a", "link"), ("not-yet", "later"), ("a", "hard")):
        assert same_file(tmp_path / one, tmp_path / other)
    for one, other in (("a", "b"), ("a", "A"), ("link", "later")):
        assert not same_file(tmp_path / one, tmp_path / other)
    # On a file system that folds capitals:
    samefile = Path.samefile
    monkeypatch.setattr(
        Path, "samefile", lambda p, q: str(p).lower() == str(q).lower() or samefile(p, q)
    )
    assert same_file(tmp_path / "new.npz", tmp_path / "NEW.npz")


def test_what_a_killed_command_left_is_removed_once_it_is_old(tmp_path: Path) -> None:
    old, new, other = (tmp_path / f".vhdl.{word}" for word in ("0" * 16, "1" * 16, "mine"))
    for folder in (old, new, other):
        folder.mkdir()
        (folder / "half.vhd").touch()
    for folder in (old, other):
        os.utime(folder, (0, 0))
    with replace_folder(tmp_path / "vhdl"):
        pass
    assert {path.name for path in tmp_path.iterdir()} == {"vhdl", new.name, other.name}


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
