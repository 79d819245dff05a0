"""Tests how commands end: by a complaint, a fault of ours, a full disk, or a closed pipe."""

import errno
import os
import resource
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from conftest import on_engine, tiered

from golden.input_error import InputError, naming
from golden.numbers.fixed import Fix
from tactus.core.cli import REPORT, run
from tactus.core.fingerprint import fingerprint
from tactus.scene import load_scene
from tactus.verify.benches.runner import Job, run_job
from tactus.verify.benches.simulate import analyse
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
        (lambda: (ROOT / "nowhere").read_text(), "FileNotFoundError: "),
        (lambda: np.linalg.inv(np.zeros((2, 2))), "LinAlgError: Singular matrix"),
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


SIZE = 1 << 20
COMMANDS = (
    "tactus.export mine.toml vhdl",
    "tactus.cli.predict mine.toml mine.csv out.csv",
    "tactus.cli.train mine.toml --force --workers=1",
    "tactus.cli.network mine.toml out.onnx",
    "tactus.report.designs mine.toml --picture=out.svg",
)
# Where a command names each of several places before it begins.
FILES = {"tactus.cli.train mine.toml --force --workers=1": 2}
# What a command may say of each disk; the last is that of a disk that is imitated by a limit.
REASONS = (
    "No space left on device",
    "Read-only file system",
    "Permission denied",
    "File too large",
)


def mounted(folder: Path, *options: str) -> bool:
    command = ["mount", "-t", "tmpfs", "-o", ",".join([f"size={SIZE}", *options]), "tmpfs", folder]
    return subprocess.run(command, capture_output=True, check=False).returncode == 0


@pytest.fixture(params=["full", "read-only"])
def disk(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[tuple[Path, Callable]]:
    """A small disk with a scene, and what a process must call before it works there.

    Where nothing can be mounted, a limit of files and the permissions of the folder stand in.
    """
    folder = tmp_path / "disk"
    folder.mkdir()
    small, limit = mounted(folder), lambda: None
    try:
        on_engine(folder, [random_mlp((3, 5, 2), 1.0, 1)])
        if request.param == "full" and small:
            (folder / "ballast").write_bytes(bytes(shutil.disk_usage(folder).free))
        elif request.param == "full":
            limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))  # noqa: E731
        elif small:
            mounted(folder, "remount", "ro")
        else:
            folder.chmod(0o555)
        yield folder, limit
    finally:
        if small:
            subprocess.run(["umount", folder], check=True)
        else:
            folder.chmod(0o755)


@pytest.mark.parametrize("words", tiered(COMMANDS[:4], COMMANDS[4:]))
def test_a_disk_without_room_is_one_line(disk: tuple[Path, Callable], words: str) -> None:
    folder, limit = disk
    before = fingerprint([folder])
    result = subprocess.run(
        [sys.executable, "-m", *words.split()],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        preexec_fn=limit,
        capture_output=True,
        text=True,
        check=False,
    )
    said = [line for line in result.stderr.splitlines() if not line.startswith("warning: ")]
    assert result.returncode == 2, result.stderr
    assert said
    assert len(said) <= FILES.get(words, 1)
    for line in said:
        assert "cannot be written" in line
        assert line.endswith(REASONS)
    shutil.rmtree(folder / "build", ignore_errors=True)
    assert fingerprint([folder]) == before


def test_what_tools_leave_out_for_want_of_room_is_no_fault_of_the_hardware(
    tmp_path: Path, monkeypatch
) -> None:
    write_scene(tmp_path, "mine", "exact", [random_mlp((3, 5, 2), 1.0, 1)])
    scene = load_scene(str(tmp_path / "mine.toml"))
    job = Job(scene, "hybrid", "hybrid", "networks", (), "icarus", build=tmp_path)
    monkeypatch.setattr("tactus.verify.benches.runner.simulate", lambda *_: False)
    assert not run_job(job).passed
    monkeypatch.setattr("tactus.core.files.ROOM", 1 << 80)
    with pytest.raises(InputError, match="the disk is full, so nothing is known of hybrid in"):
        run_job(job)
    with pytest.raises(InputError, match="the disk is full, so nothing is known of the exported"):
        analyse([tmp_path / "none.vhd"], tmp_path)
