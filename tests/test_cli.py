"""Tests how commands end: by a complaint, a fault of ours, a full disk, or a closed pipe."""

import errno
import os
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from golden.input_error import InputError, naming
from golden.numbers.fixed import Fix
from tactus.core.cli import REPORT, run
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_mlp

ROOT = Path(__file__).parents[1]


def complain() -> None:
    Fix(1, 0)


def named() -> None:
    with naming("a.npz"):
        complain()


def full() -> None:
    raise OSError(errno.ENOSPC, "No space left on device", "a.csv")


@pytest.mark.parametrize(
    ("main", "message"),
    [
        (complain, "error: Fix: width=1, expected 2 to 62\n"),
        (named, "error: a.npz: Fix: width=1, expected 2 to 62\n"),
        (full, "error: a.csv: cannot be written: No space left on device\n"),
    ],
)
def test_a_complaint_is_one_line(main: Callable[[], None], message: str, capfd) -> None:
    assert run(main) == 2
    assert capfd.readouterr().err == message


@pytest.mark.parametrize(
    ("fault", "last"),
    [
        (lambda: np.zeros(3) + np.zeros(4), "ValueError: operands could not be broadcast"),
        (lambda: int("x"), "ValueError: invalid literal for int"),
        (lambda: {}["key"], "KeyError: 'key'"),
        (lambda: (ROOT / "nowhere").read_text(), "FileNotFoundError: "),
        (lambda: np.linalg.inv(np.zeros((2, 2))), "LinAlgError: Singular matrix"),
        (lambda: naming("a").__enter__() or bytes(-1), "ValueError: negative count"),
    ],
)
def test_a_fault_of_ours_keeps_its_traceback(fault: Callable[[], object], last: str, capfd) -> None:
    """That also holds if a library raises an error that we raise for users."""

    def main() -> None:
        with naming("a.toml"):
            fault()

    assert run(main) == 1
    said = capfd.readouterr().err
    assert said.startswith("Traceback")
    assert last in said
    assert said.endswith(f"\n{REPORT}\n")


def call(*words: str, **options) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", *words],
        # No bytecode is written, because the limit on file sizes would truncate it for later
        # readers.
        env=os.environ
        | {"PYTHONPATH": str(ROOT), "PYTHONHASHSEED": "0", "PYTHONDONTWRITEBYTECODE": "1"},
        stderr=subprocess.PIPE,
        text=True,
        check=False,
        **options,
    )


def small_files(most: int) -> Callable[[], None]:
    """A function that limits the size of files in a process, like a full disk, also for root."""
    return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))


@pytest.mark.parametrize(
    ("words", "most", "message"),
    [
        (["tactus.cli.network", "mine.toml", "a.npz"], 100, "a.npz: cannot be written: "),
        (["tactus.cli.network", "mine.toml", "a.onnx"], 100, "a.onnx: cannot be written"),
        (["tactus.cli.network", "mine.toml", "a.mat"], 100, "a.mat: cannot be written: "),
        (
            ["tactus.cli.train", "mine.toml", "--workers", "1"],
            100,
            "cannot be written: File too",
        ),
        (["tactus.export", "mine.toml", "vhdl"], 2000, "build/mine/vhdl: cannot be written: "),
    ],
)
def test_a_full_disk(tmp_path: Path, words: list[str], most: int, message: str) -> None:
    write_scene(tmp_path, "mine", "exact", [random_mlp((3, 5, 2), 1.0, 1)])
    before = (tmp_path / "mine.npz").read_bytes()
    result = call(*words, cwd=tmp_path, preexec_fn=small_files(most))
    assert result.returncode == 2, result.stderr
    said = [line for line in result.stderr.splitlines() if not line.startswith("warning: ")]
    assert len(said) == 1
    assert said[0].startswith("error: ")
    assert message in said[0]
    assert (tmp_path / "mine.npz").read_bytes() == before
    assert {p.name for p in tmp_path.iterdir()} <= {
        "mine.toml",
        "mine.csv",
        "mine.npz",
        "mine.provenance.toml",
        "build",
    }


def test_output_that_cannot_be_written() -> None:
    with Path("/dev/full").open("w") as full_disk:
        result = call("tactus.cli.listing", "digit-load", cwd=ROOT, stdout=full_disk)
    assert result.returncode == 2
    assert result.stderr == (
        "error: what is printed, or a file: cannot be written: No space left on device\n"
    )


def test_a_reader_that_goes_away() -> None:
    reading, writing = os.pipe()
    os.close(reading)
    result = call("tactus.cli.listing", "digit-load", cwd=ROOT, stdout=writing)
    os.close(writing)
    assert result.returncode == 141
    assert not result.stderr


def test_an_interrupted_command_says_so(capfd) -> None:
    def main() -> None:
        raise KeyboardInterrupt

    assert run(main) == 130
    assert capfd.readouterr().err == "interrupted\n"


def test_a_command_error_is_a_complaint_wherever_it_comes_from(capfd) -> None:
    def main() -> None:
        raise InputError("SIM=a: no such simulator")

    assert run(main) == 2
    assert capfd.readouterr().err == "error: SIM=a: no such simulator\n"
