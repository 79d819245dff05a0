"""Tests that a full or read-only disk is one line, and that nothing half-written is left."""

import os
import resource
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from conftest import tiered

from golden.input_error import InputError
from tactus.core.fingerprint import ROOT, fingerprint
from tactus.scene import load_scene
from tactus.verify.benches.runner import Job, run_job
from tactus.verify.benches.simulate import analyse
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_mlp

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
        write_scene(
            folder,
            "mine",
            "exact",
            [random_mlp((3, 5, 2), 1.0, 1)],
            design="engine",
            activation="precise",
        )
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


# tests/test_cli.py has network in every run.
@pytest.mark.parametrize("words", tiered(COMMANDS[:3], COMMANDS[3:]))
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
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
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
