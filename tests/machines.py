"""``make machines``: runs the tests as on other machines, one after the other, with a line for
each.

A machine of the table is this computer with other variables, another user, another place of the
checkout, or other versions. Machines that this computer cannot imitate are named. It is an error if
the user asked for one of them.
"""

from __future__ import annotations

import argparse
import os
import pwd
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import BinaryIO

from groups import EVERYTHING, FILES, NUMBERS, ORDER, VERSIONS, Group

from golden.cli import run as run_command
from golden.cli import words, would
from golden.machine import FLAGS, SETTINGS

ROOT = Path(__file__).parents[1]
LOGS = Path("build") / "machines"


# These do not belong to the project: what .gitignore names, and the folder of git.
NOT_COPIED = (".git", ".venv*", "build", "*.egg-info", "__pycache__", ".*_cache", ".hypothesis")

# This is done before `make test`, instead of what make would install.
LOWEST = """
python3 -m venv .venv
.venv/bin/python -m pip install --quiet uv
.venv/bin/python -m uv pip install --quiet --resolution lowest-direct -e .[dev]
touch .venv/.ready"""

# As make test has it.
CORES = ("-n", "logical", "--dist", "worksteal")
X86 = 'platform.machine() == "x86_64"'
OTHER_USER = 'os.geteuid() == 0 and shutil.which("setpriv")'


@dataclass(frozen=True)
class Machine:
    """A machine to imitate.

    Parameters
    ----------
    what : str
        A description.
    group : Group
        The group, which says what it may change.
    environment : mapping
    holds : str
        A Python expression that is true if this computer behaves like that machine.
    needs : str
        A description of what is needed for that.
    copy : str
        The folder for a copy of the checkout with its own environment, or empty for no copy.
    umask : int
        The umask, or -1 to keep the present one.
    user : str
        "sudo" or "no sudo": a user who is not root, with or without a sudo that asks no password.
    python : str
        The interpreter for the copy.
    lowest : bool
        Whether the copy has the lowest versions that pyproject.toml allows.
    """

    what: str
    group: Group = EVERYTHING
    environment: Mapping[str, str] = field(default_factory=dict)
    holds: str = "True"
    needs: str = ""
    copy: str = ""
    umask: int = -1
    user: str = ""
    python: str = "python3"
    lowest: bool = False


def _numpy(name: str) -> Machine:
    without = SETTINGS[name]["NPY_DISABLE_CPU_FEATURES"].split()
    names = {"X86_V4": "AVX512", "X86_V3": "AVX2"}
    unwanted = [*without, *(names[level] for level in without)]
    return Machine(
        f"numpy without {' and '.join(names[level] for level in without)}",
        NUMBERS,
        SETTINGS[name],
        f"{X86} and not any(name in target for name in {unwanted} for target in numpy_targets())",
        "an x86-64 processor and numpy 2.4 or later",
    )


def _blas(name: str, answers: str = "") -> Machine:
    core = SETTINGS[name]["OPENBLAS_CORETYPE"]
    return Machine(
        f"OpenBLAS for {core}",
        NUMBERS,
        SETTINGS[name],
        f'{X86} and "{name}" in possible_settings() and '
        f'all("{answers or core}" in found for found in blas_cores())',
        f"an x86-64 processor with {FLAGS[name]}, and OpenBLAS",
    )


def _threads(name: str) -> Machine:
    count = int(SETTINGS[name]["OPENBLAS_NUM_THREADS"])
    return Machine(
        f"OpenBLAS on {count} thread{'s' if count > 1 else ''}",
        NUMBERS,
        SETTINGS[name],
        f'all(core.endswith("threads: {count}") for core in blas_cores())',
        f"OpenBLAS and {count} cores",
    )


def _locale(what: str, name: str) -> Machine:
    return Machine(
        what,
        FILES,
        {"LC_ALL": name},
        'locale.setlocale(locale.LC_ALL, "")',
        f"the locale {name} (Debian: apt-get install locales-all)",
    )


def _python(version: str) -> Machine:
    name = f"python{version}"
    # A program of this name may exist and fail, as those of pyenv do if another version is chosen.
    starts = f'not subprocess.run(["{name}", "-V"]).returncode'
    return Machine(
        f"Python {version}", VERSIONS, holds=starts, needs=name, copy="tactus", python=name
    )


def _debian(version: str, name: str) -> Machine:
    return Machine(
        f"Debian {version}, with its Python, GHDL and Icarus",
        holds=f'platform.freedesktop_os_release().get("VERSION_ID") == "{version}"',
        needs=f"Debian {version}; run this in a container of debian:{name}, or in a folder that "
        f"debootstrap {name} has filled",
    )


MACHINES = {
    "default": Machine("nothing changed"),
    "numpy-avx2": _numpy("numpy-avx2"),
    "numpy-sse": _numpy("numpy-sse"),
    "openblas-prescott": _blas("openblas-prescott", answers="Katmai"),
    "openblas-haswell": _blas("openblas-haswell"),
    "openblas-skylakex": _blas("openblas-skylakex"),
    "glibc-sse": Machine(
        "glibc's mathematics without AVX2, FMA and AVX512",
        NUMBERS,
        SETTINGS["glibc-sse"],
        f'{X86} and platform.libc_ver()[0] == "glibc"',
        "an x86-64 processor and glibc",
    ),
    "one-thread": _threads("one-thread"),
    "two-threads": _threads("two-threads"),
    "hash-seed-1": Machine("order of sets", ORDER, {"PYTHONHASHSEED": "1"}),
    "hash-seed-2": Machine("another order of sets", ORDER, {"PYTHONHASHSEED": "2"}),
    "locale-c": _locale("no locale", "C"),
    "locale-german": _locale("decimal comma", "de_DE.UTF-8"),
    "locale-latin": _locale("letters that are not UTF-8", "de_DE.ISO-8859-1"),
    "locale-turkish": _locale("an i without a capital I", "tr_TR.UTF-8"),
    "time-zone": Machine("a date of its own", FILES, {"TZ": "Pacific/Chatham"}),
    "umask": Machine("files that nobody else may read", FILES, copy="tactus", umask=0o077),
    "path": Machine("a path with blanks and a letter beyond ASCII", FILES, copy="takt \u00fc s"),
    "sudo": Machine(
        "not root, sudo asks no password",
        FILES,
        holds=f'{OTHER_USER} and shutil.which("unshare") and shutil.which("sudo")',
        needs="root, sudo and unshare",
        copy="tactus",
        user="sudo",
    ),
    "no-sudo": Machine(
        "not root and no sudo", FILES, holds=OTHER_USER, needs="root", copy="tactus", user="no sudo"
    ),
    "lowest": Machine(
        "the lowest versions that pyproject.toml allows", VERSIONS, copy="tactus", lowest=True
    ),
    "highest": Machine("the highest versions that pyproject.toml allows", VERSIONS, copy="tactus"),
    "python-3.11": _python("3.11"),
    "python-3.13": _python("3.13"),
    "debian-12": _debian("12", "bookworm"),
    "debian-13": _debian("13", "trixie"),
    "arm64": Machine(
        "an ARM processor",
        holds='platform.machine() in ("aarch64", "arm64")',
        needs="an ARM processor",
    ),
}


def main() -> int:
    parser = argparse.ArgumentParser(prog="make machines", description=__doc__)
    parser.add_argument("--only", default="", help="names of machines; all if empty")
    parser.add_argument("--tests", default="", help="arguments of pytest instead of the group")
    parser.add_argument("--whole", action="store_true", help="all of make test on each")
    parser.add_argument("--all", action="store_true", help="that, and what make test ALL=1 adds")
    parser.add_argument("--show", action="store_true", help="print what the tests print")
    arguments = parser.parse_args()
    names = words("ONLY", arguments.only)
    for name in names:
        if name not in MACHINES:
            print(
                f"error: {name}: no such machine, expected {', '.join(MACHINES)}", file=sys.stderr
            )
            return 2
    chosen = words("TESTS", arguments.tests)
    would(f"run tests as on {', '.join(names or MACHINES)}")
    results: dict[str, str] = {}
    for name in names or MACHINES:
        machine = MACHINES[name]
        group = EVERYTHING if arguments.whole or arguments.all else machine.group
        tests = chosen or [f"--deselect=tests/{test}" for test in group.leaves_out()]
        if arguments.all:
            tests = ["--all", *tests]
        ran = [n for n, word in results.items() if word != "not run" and same(MACHINES[n], machine)]
        if not is_possible(machine):
            results[name] = "not run"
            print(f"not run  {name:18} needs {machine.needs}", flush=True)
        elif ran:
            results[name] = results[ran[0]]
            print(f"{results[name]}   {name:18} is {ran[0]} here", flush=True)
        else:
            results[name] = tell(name, "chosen" if chosen else group.name, tests, arguments.show)
    verdicts = list(results.values())
    if len(verdicts) > 1:
        counts = [f"{verdicts.count(word)} {word}" for word in ("passed", "failed", "not run")]
        print(f"machines: {', '.join(counts)}")
    if "failed" in verdicts:
        return 1
    return 2 if names and "not run" in verdicts else 0


def same(one: Machine, other: Machine) -> bool:
    """Whether both machines are imitated in the same way, so that one run covers both."""
    names = {"what": "", "holds": "", "needs": ""}
    return replace(one, **names) == replace(other, **names)


def tell(name: str, selection: str, tests: list[str], show: bool) -> str:
    """Run the tests as the machine of that name, and print and return the result."""
    machine = MACHINES[name]
    started = time.perf_counter()
    with tempfile.TemporaryFile() as output:
        passed = run(machine, tests, None if show else output) == 0
        output.seek(0)
        text = output.read()
    word = "passed" if passed else "failed"
    if not show:
        log = LOGS / f"{name}.log"
        (ROOT / log).parent.mkdir(parents=True, exist_ok=True)
        (ROOT / log).write_bytes(text)
        where = "" if passed else f"; see {log}"
        seconds = time.perf_counter() - started
        said = f"{closing(text.decode(errors='replace'))}{where}"
        print(f"{word}   {name:18} {selection:10} {seconds:4.0f} s  {said}", flush=True)
    return word


def closing(text: str) -> str:
    """The last line of pytest, after which make may print a complaint, or else the last line."""
    lines = text.strip().split("\n")
    counts = [line for line in lines if re.search(r"\d (passed|failed|error).* in \d", line)]
    return (counts or lines)[-1].strip("= ")


def is_possible(machine: Machine) -> bool:
    """Whether this computer can imitate the machine: its condition holds in its environment."""
    imports = "import locale, os, platform, shutil, subprocess; from golden.machine import *"
    command = [sys.executable, "-c", f"{imports}\nassert {machine.holds}"]
    environment = os.environ | machine.environment
    return not subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, check=False
    ).returncode


def run(machine: Machine, tests: list[str], output: BinaryIO | None) -> int:
    """Run the tests as that machine, and return the exit code."""
    if not machine.copy:
        return call([sys.executable, "-m", "pytest", *CORES, *tests], ROOT, machine, output)
    with tempfile.TemporaryDirectory(prefix="tactus-") as name:
        home = Path(name)
        folder = home / machine.copy
        copy_checkout(folder, machine)
        given = [f"TESTS={shlex.join(tests)}", f"PYTHON={machine.python}", "VENV=.venv"]
        command = ["make", "--no-print-directory", "test", "MACHINE=", *given]
        if machine.lowest:
            command = ["sh", "-e", "-c", f"{LOWEST}\n{shlex.join(command)}"]
        if machine.user:
            command = as_nobody(command, home, machine.user == "sudo")
        return call(command, folder, machine, output)


def call(command: list[str], folder: Path, machine: Machine, output: BinaryIO | None) -> int:
    """Run a command in the environment of the machine, and return its exit code."""
    # The variables of this make are not passed to the make of the copy.
    environment = {k: v for k, v in os.environ.items() if not k.startswith("MAKE")}
    if machine.user:
        environment["HOME"] = str(folder.parent)
    return subprocess.run(
        command,
        cwd=folder,
        env=environment | machine.environment,
        umask=machine.umask,
        stdin=subprocess.DEVNULL,
        stdout=output,
        stderr=subprocess.STDOUT if output else None,
        check=False,
    ).returncode


def copy_checkout(folder: Path, machine: Machine) -> None:
    """Copy the present files of this checkout to ``folder``."""
    shutil.copytree(ROOT, folder, ignore=shutil.ignore_patterns(*NOT_COPIED))
    if machine.umask != -1:
        for path in (folder, *folder.rglob("*")):
            path.chmod(path.stat().st_mode & ~machine.umask)


def as_nobody(command: list[str], home: Path, sudo: bool) -> list[str]:
    """The command as the user nobody, who owns ``home``, would run it.

    With ``sudo`` this user needs no password for sudo. That holds only in a name space that ends
    with the command.
    """
    nobody = pwd.getpwnam("nobody")
    for path in (home, *home.rglob("*")):
        os.chown(path, nobody.pw_uid, nobody.pw_gid)
    identity = [f"--reuid={nobody.pw_uid}", f"--regid={nobody.pw_gid}", "--clear-groups"]
    command = ["setpriv", *identity, *command]
    if not sudo:
        return command
    sudoers = home / "sudoers"
    sudoers.write_text("nobody ALL=(ALL) NOPASSWD: ALL\n", encoding="utf-8")
    sudoers.chmod(0o440)
    script = f'mount --bind {shlex.quote(str(sudoers))} /etc/sudoers; exec "$@"'
    return ["unshare", "--mount", "sh", "-e", "-c", script, "sh", *command]


if __name__ == "__main__":
    sys.exit(run_command(main))
