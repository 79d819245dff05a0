"""Tests that a signal ends a command with one line, its processes, and its temporary files."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest
from conftest import tiered
from test_make import environment

from tactus.core.fingerprint import ROOT
from tactus.core.hold import VARIABLE, held
from tactus.verify.benches.collected import CASES_OF
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_mlp

LIMIT = 120
# Writes a folder, while threads wait for processes that end only by a signal, and would keep how
# they ended.
THREADS = """
import subprocess, sys, time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from tactus.core import store
from tactus.core.cli import run
from tactus.core.files import replace_folder

def judge(n):
    waits = lambda: subprocess.run(["sleep", "1000"]).returncode
    return store.cached(store.key("judged", n=n), waits, Path(sys.argv[1]))

def main():
    with replace_folder(Path(sys.argv[1]) / "vhdl") as folder, ThreadPoolExecutor(1) as pool:
        (folder / "half").touch()
        waiting = [pool.submit(judge, n) for n in range(3)]
        time.sleep(1)
        print("ready", flush=True)
        for one in waiting:
            one.result()

sys.exit(run(main))
"""


@contextmanager
def started(*command: str, folder: Path = ROOT) -> Iterator[subprocess.Popen[str]]:
    """A command in a session of its own, all of which is killed at the end."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    with subprocess.Popen(
        command,
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    ) as process:
        try:
            yield process
        finally:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)


def wait(condition: Callable[[], object]) -> None:
    end = time.monotonic() + LIMIT
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.05)


def alive(session: int) -> dict[int, str]:
    """The names of the processes of a session that have not ended."""
    found = {}
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            name, _, others = path.read_text().rpartition(")")
        except OSError:
            continue
        state, _, _, its_session, *_ = others.split()
        if int(its_session) == session and state != "Z":
            found[int(path.parent.name)] = name
    return found


def beginning(session: int) -> bool:
    """Whether a worker of joblib has begun to run Python, which would now notice Ctrl-C."""
    with suppress(OSError):
        for folder in (Path(f"/proc/{one}") for one in alive(session)):
            status = (folder / "status").read_text()
            caught = int(status.partition("SigCgt:")[2].split()[0], 16) >> (signal.SIGINT - 1)
            if caught & 1 and b"popen_loky" in (folder / "cmdline").read_bytes():
                return True
    return False


@pytest.mark.parametrize(
    ("number", "said"), [(signal.SIGTERM, "terminated"), (signal.SIGINT, "interrupted")]
)
def test_a_search_ends_with_its_workers_and_its_shared_memory(
    tmp_path: Path, number: int, said: str
) -> None:
    write_scene(tmp_path, "mine", "exact", [random_mlp((3, 20, 2), 1.0, 1)])
    command = [sys.executable, "-m", "tactus.cli.train", "mine.toml"]
    with started(*command, folder=tmp_path) as search:
        wait(lambda: beginning(search.pid))
        if number == signal.SIGINT:
            # Ctrl-C reaches the workers too, maybe long before the command.
            search.send_signal(signal.SIGSTOP)
            os.killpg(search.pid, number)
            time.sleep(1)
            search.send_signal(signal.SIGCONT)
        else:
            search.send_signal(number)
        output = search.communicate(timeout=LIMIT)[0]
        assert output.splitlines()[-1] == said
        assert "Traceback" not in output
        assert search.returncode == 128 + number
        wait(lambda: not alive(search.pid))
        assert not list(Path("/dev/shm").glob(f"*[-_]{search.pid}[-_]*"))


def test_processes_that_threads_wait_for_end_and_nothing_of_theirs_stays(tmp_path: Path) -> None:
    with started(sys.executable, "-c", THREADS, str(tmp_path)) as command:
        assert command.stdout.readline() == "ready\n"
        command.terminate()
        assert command.communicate(timeout=LIMIT)[0] == "terminated\n"
        assert command.returncode == 128 + signal.SIGTERM
        assert not alive(command.pid)
        assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("goal", ["docs", "ready"])
def test_what_a_recipe_has_started_ends_with_make(tmp_path: Path, goal: str) -> None:
    words = [f"PYTHON={sys.executable}", f"VENV={tmp_path / 'venv'}", f"SITE={tmp_path / 'site'}"]
    if goal != "ready":
        environment(tmp_path, instead="echo begun; sleep 1000; exit")
    with started("make", "--no-print-directory", *words, goal) as command:
        assert command.stdout.readline() in ("begun\n", f"setting up {tmp_path / 'venv'}\n")
        command.terminate()
        assert "terminated\n" in command.communicate(timeout=LIMIT)[0]
        assert not alive(command.pid)


WAITS = "from tactus.core.hold import held; import sys; from pathlib import Path\n"
WAITS += "with held([Path(sys.argv[1])]): print('has it', flush=True); sys.stdin.read()"


def waiting(folder: Path, **variables: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", WAITS, str(folder)],
        cwd=ROOT,
        env=os.environ | variables,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )


def test_a_second_command_names_the_first_and_waits_for_its_end(tmp_path: Path) -> None:
    with waiting(tmp_path / "mine") as first:
        assert first.stdout.readline() == "has it\n"
        with waiting(tmp_path / "mine") as second:
            said = second.stdout.readline()
            assert said.startswith(f"{tmp_path / 'mine'}: waiting for process {first.pid}, ")
            first.stdin.close()
            assert second.communicate()[0].splitlines()[-1] == "has it"


def test_a_command_that_was_called_by_the_first_does_not_wait(tmp_path: Path) -> None:
    with held([tmp_path / "mine"]), waiting(tmp_path / "mine") as called:
        assert called.stdout.readline() == "has it\n"
        called.communicate()
    assert VARIABLE not in os.environ or not os.environ[VARIABLE]


@pytest.mark.parametrize("blocked", [0o500, None])
def test_a_folder_that_cannot_be_held_is_left_to_those_that_write(
    tmp_path: Path, blocked: int | None
) -> None:
    place = tmp_path / "there"
    place.touch() if blocked is None else place.mkdir(mode=blocked)
    with held([place / "mine"]):
        pass


@pytest.mark.parametrize(
    "words",
    tiered(
        ["tactus.verify.sim same.toml --sim=icarus", "tactus.verify.prove --block=abs_unit"],
        [
            "tactus.cli.demo same.toml",
            "tactus.export same.toml vhdl",
            "tactus.report same.toml",
            "tactus.certify same.toml",
            "tactus.verify.sign_off.mutate --scene=same.toml",
            "tactus.verify.sign_off.mutate --block=abs_unit",
            "tactus.verify.sign_off.coverage --block=abs_unit",
            "tactus.verify.sim --block=abs_unit --netlist=1 --record",
        ],
    ),
)
def test_commands_wait_for_others_on_the_same_folder(tmp_path: Path, words: str) -> None:
    write_scene(tmp_path, "same", "exact", [random_mlp((3, 4, 2), 1.0, 1)])
    name = CASES_OF["abs_unit"][0] if "--block" in words else "same"
    with (
        held([tmp_path / "build" / name]),
        subprocess.Popen(
            [sys.executable, "-m", *words.split()],
            cwd=tmp_path,
            env=os.environ | {"PYTHONPATH": str(ROOT), VARIABLE: ""},
            stdout=subprocess.PIPE,
            text=True,
        ) as command,
    ):
        try:
            assert any(f"waiting for process {os.getpid()}," in line for line in command.stdout)
        finally:
            command.kill()


def test_a_second_search_takes_what_the_first_has_found(tmp_path: Path) -> None:
    write_scene(tmp_path, "same", "exact", [random_mlp((3, 4, 2), 1.0, 1)])
    searches = [
        subprocess.Popen(
            [sys.executable, "-m", "tactus.cli.train", "same.toml", "--workers=1"],
            cwd=tmp_path,
            env=os.environ | {"PYTHONPATH": str(ROOT)},
            stdout=subprocess.DEVNULL,
        )
        for _ in range(2)
    ]
    assert [search.wait() for search in searches] == [0, 0]
    (record,) = tmp_path.glob("build/store/training/*/0.jsonl")
    lines = record.read_text().splitlines()
    assert len(lines) == len(set(lines)) > 0
