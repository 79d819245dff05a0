"""Tests make: what it lists, passes on unchanged and refuses, and what a signal ends and waits."""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from itertools import cycle
from pathlib import Path
from types import SimpleNamespace

import pytest
from conftest import ROOT, pytest_collection_modifyitems, tiered
from shared import CALL, movable, run

from tactus.cli.commands import WIDTH
from tactus.core.commands import CLOSING, COMMANDS
from tactus.core.hold import VARIABLE, held
from tactus.scene import scene_names, scene_path
from tactus.verify.benches.collected import CASES_OF
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_mlp

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
BEGIN = "a call"


def environment(folder: Path, venv: str = "venv", instead: str = "") -> Path:
    """A virtual environment that seems ready, whose python only logs its arguments, or does what
    the text of a shell says ``instead``. ``tactus.cli.commands`` it runs as the real one does."""
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
printf '%s\\0' '{BEGIN}' "$@" >> '{log}'
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
        if word == BEGIN:
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
            _, _, module, *others = arrived[command.name]
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
    assert [words[3:] for words in calls(log)] == [[nasty, other], [f"--scene={nasty}"]]


def test_a_scene_that_is_not_given_is_chosen(tmp_path: Path) -> None:
    """The table chooses the scene or, if it names none, the command does."""
    log = environment(tmp_path)
    names = ("listing", "sim", "vhdl", "monitor", "mutate", "demo")
    result = make(tmp_path, f"VENV={tmp_path / 'venv'}", *names, "PORT=twin")
    assert result.returncode == 0, result.stderr
    words = [call[3:] for call in calls(log)]
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
        ("sim WAVES=2", "WAVES=2: expected 1"),
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
    for block in ("readout", "uart_instrument"):
        words = ["sim", f"SCENE={own}", f"BLOCK={block}", "SIM=icarus"]
        said = make(ROOT, "-o", "ready", f"VENV={sys.prefix}", *words)
        assert said.returncode == 0, said.stdout + said.stderr
        assert "1 benches, 0 failed" in said.stdout


def here(*words: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run make with the environment of this interpreter, so that nothing is installed."""
    return make(ROOT, f"VENV={sys.prefix}", *words, **({"MAKEFLAGS": ""} | environment))


def test_make_alone_lists_the_commands_before_anything_is_installed(tmp_path: Path) -> None:
    """It runs with a Python that only has its standard library, and without an environment."""
    python = tmp_path / "python3"
    python.write_text(f'#!/bin/sh\nexec "{sys.executable}" -E -S "$@"\n')
    python.chmod(0o755)
    result = here("PYTHON=python3", "VENV=none", PATH=f"{tmp_path}:{os.environ['PATH']}")
    assert result.returncode == 0, result.stderr
    assert not (ROOT / "none").exists()
    assert re.findall(r"^make ([a-z]+)", result.stdout, re.M) == [c.name for c in COMMANDS]
    told = " ".join(result.stdout.split())
    for command in COMMANDS:
        assert f"{command.usage} {command.purpose}" in told
    assert told.endswith(f"one of {', '.join(scene_names())}. {CLOSING}")
    assert max(map(len, result.stdout.splitlines())) <= WIDTH


def test_an_old_python_is_named(tmp_path: Path) -> None:
    python = tmp_path / "python3"
    python.write_text('#!/bin/sh\n[ "$1" = -V ] && echo Python 3.10.1\nexit 1\n')
    python.chmod(0o755)
    # An environment that is ready is asked instead.
    assert here(f"PYTHON={python}", "help").returncode == 0
    result = here(f"PYTHON={python}", "VENV=none")
    assert result.returncode == 2
    said = f"error: {python} is Python 3.10.1, expected Python 3.11 to 3.13; set PYTHON=\n"
    assert result.stderr.startswith(said)


@pytest.fixture(scope="module", autouse=True)
def ready() -> None:
    """Mark the present environment as ready, so that make does not set it up again."""
    (Path(sys.prefix) / ".ready").touch()


def test_a_missing_simulator_is_named_with_its_package(tmp_path: Path) -> None:
    for program in ("python", "bash", "env"):
        found = shutil.which(program)
        if found:
            (tmp_path / program).symlink_to(found)
    words = [*CALL, "tactus.verify.sim", "digit-single", "--block", "hybrid", "--sim"]
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
        result = here("sim", "BLOCK=abs_unit", "SIM=icarus", f"SCENE={path}", "SEED=7", "WAVES=1")
        assert result.returncode == 0, result.stdout + result.stderr
        assert re.search(r"^pass +icarus +abs_unit +\d+ compared", result.stdout, re.M)
        assert re.search(r"1 benches, 0 failed, [1-9]\d+ results compared", result.stdout)
        wave = re.search(r"^waves: (.*\.fst)$", result.stdout, re.M)
        assert Path(wave[1]).stat().st_size > 0
    finally:
        shutil.rmtree(ROOT / "build" / "mine", ignore_errors=True)


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
def started(
    *command: str, folder: Path = ROOT, **variables: str
) -> Iterator[subprocess.Popen[str]]:
    """A command in a session of its own, all of which is killed at the end."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)} | variables
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
    command = [*CALL, "tactus.cli.train", "mine.toml"]
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


def waiting(folder: Path) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", WAITS, str(folder)],
        cwd=ROOT,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )


def test_a_second_command_waits_for_the_end_of_the_first(tmp_path: Path) -> None:
    with waiting(tmp_path / "mine") as first:
        assert first.stdout.readline() == "has it\n"
        with waiting(tmp_path / "mine") as second:
            said = second.stdout.readline()
            assert said.startswith(f"{tmp_path / 'mine'}: waiting for another command")
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
            "tactus.export.command same.toml vhdl",
            "tactus.report.page.build same.toml",
            "tactus.certify.command same.toml",
            "tactus.verify.sign_off.mutate.score --scene=same.toml",
            "tactus.verify.sign_off.mutate.score --block=abs_unit",
            "tactus.verify.sim --block=abs_unit --netlist=1 --record",
        ],
    ),
)
def test_commands_wait_for_others_on_the_same_folder(tmp_path: Path, words: str) -> None:
    write_scene(tmp_path, "same", "exact", [random_mlp((3, 4, 2), 1.0, 1)])
    name = CASES_OF["abs_unit"][0] if "--block" in words else "same"
    given = {"folder": tmp_path, VARIABLE: ""}
    with held([tmp_path / "build" / name]), started(*CALL, *words.split(), **given) as command:
        assert any("waiting for another command" in line for line in command.stdout)


def test_a_second_search_takes_what_the_first_has_found(tmp_path: Path) -> None:
    write_scene(tmp_path, "same", "exact", [random_mlp((3, 4, 2), 1.0, 1)])
    words = (*CALL, "tactus.cli.train", "same.toml", "--workers=1")
    with started(*words, folder=tmp_path) as first, started(*words, folder=tmp_path) as second:
        assert (first.wait(LIMIT), second.wait(LIMIT)) == (0, 0)
    (record,) = tmp_path.glob("build/store/training/*/0.jsonl")
    lines = record.read_text().splitlines()
    assert len(lines) == len(set(lines)) > 0


@pytest.mark.parametrize("workers", ["", "1", "2", "3", "8"])
def test_all_keeps_each_test_once(monkeypatch, workers: str) -> None:
    monkeypatch.setenv("PYTEST_XDIST_WORKER_COUNT", workers)
    items = [
        SimpleNamespace(
            number=n,
            path=Path("test_certify.py" if n % 4 else "test_make.py"),
            get_closest_marker=lambda _, n=n: n % 3 == 0,
        )
        for n in range(50)
    ]
    pytest_collection_modifyitems(SimpleNamespace(getoption=lambda _: True), items)
    assert sorted(item.number for item in items) == list(range(50))
