"""Tests how commands end, how ``tactus`` reads their table, and that a wheel is complete."""

import errno
import os
import re
import resource
import shutil
import subprocess
import sys
import tomllib
import venv
from collections.abc import Callable, Iterator
from importlib.metadata import files, requires, version
from pathlib import Path

import numpy as np
import pytest
from click.shell_completion import ShellComplete
from click.testing import CliRunner, Result
from conftest import on_engine
from packaging.requirements import Requirement
from shared import CALL
from shared import run as shared_run

from golden.input_error import InputError, naming
from golden.numbers.fixed import Fix
from tactus.cli import commands, console
from tactus.core import folders
from tactus.core.cli import REPORT, run
from tactus.core.commands import BY_NAME, COMMANDS, Command
from tactus.core.files import check_writable
from tactus.core.finding import faults
from tactus.core.fingerprint import fingerprint
from tactus.rig.check import everything
from tactus.scene import Scene
from tactus.verify.benches.blocks import block_names
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
        [*CALL, *words],
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
WRITING = (
    "tactus.export.command mine.toml vhdl",
    "tactus.cli.predict mine.toml mine.csv out.csv",
    "tactus.cli.train mine.toml --force --workers=1",
    "tactus.cli.network mine.toml out.onnx",
)
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


@pytest.mark.parametrize("words", WRITING)
def test_a_disk_without_room_is_one_line(disk: tuple[Path, Callable], words: str) -> None:
    folder, limit = disk
    before = fingerprint([folder])
    result = call(*words.split(), cwd=folder, preexec_fn=limit, stdout=subprocess.DEVNULL)
    said = [line for line in result.stderr.splitlines() if not line.startswith("warning: ")]
    assert result.returncode == 2, result.stderr
    assert said
    # Training names each of two places before it begins.
    assert len(said) <= 1 + ("train" in words)
    for line in said:
        assert "cannot be written" in line
        assert line.endswith(REASONS)
    shutil.rmtree(folder / "build", ignore_errors=True)
    assert fingerprint([folder]) == before


OFFERED = [command for command in COMMANDS if command.module]
MAKES = [command for command in COMMANDS if not command.module]
# A value for each variable. A flag has none.
VALUE = "a b"


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> list[list[str]]:
    """The words with which Python would have been started. It is not started."""
    found: list[list[str]] = []
    monkeypatch.setattr(commands.os, "execv", lambda _, words: found.append(words[1:]))
    monkeypatch.setenv("DRY", "")
    monkeypatch.setenv("PYTHONSAFEPATH", "")
    return found


def invoke(*words: str) -> Result:
    return CliRunner().invoke(console.front(), list(words))


def options(command: Command, given: dict[str, str]) -> list[str]:
    """A command line with the same values as for make."""
    words = [command.name]
    for argument in command.arguments:
        if argument.name not in given:
            continue
        if argument.name == "SCENE":
            words.append(given["SCENE"])
        elif argument.flag:
            words.append(f"--{argument.name.lower()}")
        else:
            words.append(f"--{argument.name.lower()}={given[argument.name]}")
    return words


@pytest.mark.parametrize("command", OFFERED, ids=lambda c: c.name)
def test_a_command_hands_on_what_it_is_given(command: Command, started: list[list[str]]) -> None:
    """It does so as make does, with all variables or only the required ones, and none twice."""
    everything_given = {a.name: "1" if a.flag else VALUE for a in command.arguments}
    needed = {a.name: VALUE for a in command.arguments if a.needed}
    for given in (everything_given, needed):
        result = invoke(*options(command, given))
        assert result.exit_code == 0, result.output
        assert started.pop() == command.words(given)
        assert not started
    assert os.environ["DRY"] == ""
    assert invoke(*options(command, needed), "--dry").exit_code == 0
    assert os.environ["DRY"] == "1"


def called(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    """Run a command line, and return its exit code."""
    monkeypatch.setattr(sys, "argv", ["tactus", *words])
    return console.main()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["demoo"], "demoo: no such command, expected one of .*; did you mean 'demo'?"),
        (["zzz"], "zzz: no such command, expected one of demo, .*, report"),
        (["sim", "--blok=x"], "tactus sim: No such option.*--blok.*--block.* See: tactus sim"),
        (["sim", "a", "b"], "tactus sim: Got unexpected extra argument (b). See: tactus sim"),
        (["predict"], "tactus predict: Missing option '--csv'.* See: tactus predict --help"),
        (["--dry"], "tactus: No such option.*--dry.* See: tactus --help"),
        *[([c.name], f"{c.name}: is a command of a checkout.*: make {c.name}") for c in MAKES],
    ],
)
def test_a_wrong_command_line_is_one_message(
    words: list[str], message: str, started: list[list[str]], monkeypatch, capfd
) -> None:
    assert called(monkeypatch, *words) == 2
    out, said = capfd.readouterr()
    assert re.fullmatch(f"error: {re.escape(message)}.*\n".replace(r"\.\*", ".*"), said), said
    assert not out
    assert not started


def test_alone_it_lists_its_commands(monkeypatch, capfd) -> None:
    assert called(monkeypatch) == 0
    # click would use another width in a test.
    assert capfd.readouterr().out.split() == invoke("--help").output.split()
    assert called(monkeypatch, "--version") == 0
    assert capfd.readouterr().out == f"tactus {version('tactus')}\n"


@pytest.mark.parametrize(
    ("words", "begun", "offered"),
    [
        ([], "ver", ["verilog"]),
        (["vhdl"], "digit-s", ["digit-single", "digit-single-thesis"]),
        (["sim"], "--bl", ["--block"]),
        (["sim", "--block"], "grad_", [n for n in block_names() if n.startswith("grad_")]),
        (["sim", "--sim"], "", ["ghdl", "icarus"]),
        (["lean", "--beside"], "thes", ["thesis"]),
    ],
)
def test_what_a_shell_completes(words: list[str], begun: str, offered: list[str]) -> None:
    completion = ShellComplete(console.front(), {}, "tactus", "_TACTUS_COMPLETE")
    assert [item.value for item in completion.get_completions(words, begun)] == offered


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of packages in which tactus seems to be installed, as pip does it."""
    monkeypatch.setattr(folders, "ROOT", tmp_path / "site-packages")
    return folders.ROOT


def test_what_pip_has_installed_is_not_written(installed: Path, tmp_path: Path) -> None:
    for room in folders.ROOMS:
        with pytest.raises(InputError, match="cannot be written: it belongs to the installed pack"):
            check_writable([installed / room / "a.json"])
    assert not (installed / "tb").exists()
    check_writable([tmp_path / "build" / "a.json", installed / "build" / "a.json"])


def test_a_scene_that_pip_has_installed_has_no_fault(
    small_scene: Scene, tmp_path: Path, monkeypatch
) -> None:
    monkeypatch.setattr("tactus.rig.check.is_installed", lambda _: True)
    found = everything(small_scene, tmp_path / "build")
    assert not faults(found)
    assert any("belongs to the installed package" in finding.text for finding in found)


@pytest.mark.parametrize("words", [["prove"], ["sim", "digit"], ["synth", "digit"]])
def test_records_belong_to_a_checkout(
    words: list[str], installed: Path, started: list[list[str]], monkeypatch, capfd
) -> None:
    assert called(monkeypatch, *words, "--record") == 2
    assert capfd.readouterr().err.startswith("error: --record: the records of blocks, ")
    assert not started
    assert called(monkeypatch, "synth", "mine.toml", "--record") == 0
    assert started.pop() == BY_NAME["synth"].words({"SCENE": "mine.toml", "RECORD": "1"})


def test_the_wheel_has_every_kind_of_file() -> None:
    """A file with another suffix would be missing after pip has installed the wheel."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    packed = {name.removeprefix("*") for name in project["tool"]["setuptools"]["package-data"]["*"]}
    rooms = [ROOT / room for room in folders.ROOMS]
    there = {path.suffix for room in rooms for path in room.rglob("*") if path.is_file()}
    assert there - {".pyc"} == packed | {".py"}


def required(name: str) -> set[str]:
    """The distributions that one requires here without any extra, and what those require."""
    found, due = set[tuple[str, str]](), {(name, "")}
    while due:
        one, extra = due.pop()
        found.add((one, extra))
        for r in map(Requirement, requires(one) or []):
            if r.marker is None or r.marker.evaluate({"extra": extra}):
                due |= {(r.name, e) for e in ("", *r.extras)} - found
    found.remove((name, ""))
    return {one for one, _ in found}


@pytest.mark.all_only
def test_a_wheel_works_from_any_folder(tmp_path: Path) -> None:
    """The wheel is built from a copy, because setuptools leaves files beside the source."""
    source, prefix, place = (tmp_path / name for name in ("source", "prefix", "place"))
    for room in folders.ROOMS:
        shutil.copytree(ROOT / room, source / room, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, source)
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "-q"]
    offline = ["--no-deps", "--no-build-isolation"]
    subprocess.run([*pip, "wheel", *offline, "-w", tmp_path, source], check=True)
    (wheel,) = tmp_path.glob("*.whl")
    venv.create(prefix, with_pip=False)
    (packages,) = (prefix / "lib").glob("python*/site-packages")
    subprocess.run(
        [*pip, "--python", prefix / "bin" / "python", "install", "--no-deps", wheel], check=True
    )
    # Of this environment it sees only what the wheel requires: what pip would have installed.
    for name in {path.parts[0] for one in required("tactus") for path in files(one) or []} - {".."}:
        (packages / name).symlink_to(Path(pytest.__file__).parents[1] / name)
    shutil.rmtree(source)
    before = {path for path in packages.rglob("*") if path.suffix != ".pyc"}
    # A user's folders with the names of our packages are not used instead of them.
    (place / "tb").mkdir(parents=True)
    (place / "tb" / "__init__.py").write_text("raise SystemExit('not this one')\n")

    def tactus(*words: str) -> subprocess.CompletedProcess[str]:
        return shared_run(prefix / "bin" / "tactus", *words, folder=place)

    for words in (["check", "digit"], ["vhdl", "digit"], ["demo", "digit-load"]):
        done = tactus(*words)
        assert done.returncode == 0, f"{words}\n{done.stdout}{done.stderr}"
    assert (place / "build" / "digit" / "vhdl" / "compile_order.txt").is_file()
    refused = tactus("train", "digit")
    assert refused.returncode == 2
    assert "belongs to the installed package" in refused.stderr
    assert "did you mean 'check'?" in tactus("chekc").stderr
    after = {path for path in packages.rglob("*") if path.suffix != ".pyc"}
    assert {path for path in after - before if path.name != "__pycache__"} == set()
    assert {path.name for path in place.iterdir()} == {"tb", "build"}
