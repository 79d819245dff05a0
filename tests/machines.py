"""``make machines``: the tests under what other machines have, one after the other, a line each.

A machine of the table is this one with other variables, another user, another place of the checkout
or other versions. What this machine cannot be is said by name, and is an error where it was asked
for by name.
"""

from __future__ import annotations

import argparse
import os
import pwd
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

ROOT = Path(__file__).parents[1]
LOGS = Path("build") / "machines"

# What these do is done in a simulator or in Yosys, on exported files. That the files are the bytes
# that were recorded is shown by test_synth.py among those that are run; SIMULATED=1 runs these too.
SIMULATED = (
    "test_benches.py",
    "test_benches_can_fail.py",
    "test_cells.py",
    "test_export.py::test_ghdl_accepts_every_file_in_the_listed_order",
    "test_export.py::test_vhdl_synthesises_without_a_latch",
    "test_handover.py::test_a_fault_in_an_entity_fails",
    "test_handover.py::test_every_recorded_frame_matches",
    "test_handover.py::test_the_examples_compile",
    "test_lean.py::test_the_savings_are_those_of_two_builds",
    "test_report.py",
    "test_synth.py::test_the_command",
    "test_synth.py::test_the_recorded_cells_are_those_that_yosys_finds",
)

# Not the project's: what .gitignore names, and git's own.
NOT_COPIED = (".git", ".venv*", "build", "*.egg-info", "__pycache__", ".*_cache", ".hypothesis")

# Before `make test`, in place of what make would install.
LOWEST = """
python3 -m venv .venv
.venv/bin/python -m pip install --quiet uv
.venv/bin/python -m uv pip install --quiet --resolution lowest-direct -e .[dev]
touch .venv/.ready"""

# As the Makefile has it.
CORES = ("-n", "logical", "--dist", "worksteal")
X86 = 'platform.machine() == "x86_64"'
OTHER_USER = 'os.geteuid() == 0 and shutil.which("setpriv")'


@dataclass(frozen=True)
class Machine:
    """A machine to be.

    Parameters
    ----------
    what : str
        In words.
    environment : mapping
    holds : str
        A Python expression that is true where this machine is that one.
    needs : str
        What is needed for that, in words.
    copy : str
        The folder of a copy of the checkout, with an environment of its own; empty for none.
    umask : int
        -1 for that which is.
    user : str
        "sudo" or "no sudo": not root, with or without sudo that asks no password.
    python : str
        The interpreter of a copy.
    lowest : bool
        The lowest versions that pyproject.toml allows, in a copy.
    """

    what: str
    environment: Mapping[str, str] = field(default_factory=dict)
    holds: str = "True"
    needs: str = ""
    copy: str = ""
    umask: int = -1
    user: str = ""
    python: str = "python3"
    lowest: bool = False


def _numpy(*without: str) -> Machine:
    features = " ".join(without)
    names = {"X86_V4": "AVX512", "X86_V3": "AVX2"}
    unwanted = [*without, *(names[name] for name in without)]
    return Machine(
        f"numpy without {' and '.join(names[name] for name in without)}",
        {"NPY_DISABLE_CPU_FEATURES": features},
        f"{X86} and not any(name in target for name in {unwanted} for target in numpy_targets())",
        "an x86-64 processor and numpy 2.4 or later",
    )


def _blas(core: str, flag: str, answers: str = "") -> Machine:
    return Machine(
        f"OpenBLAS for {core}",
        {"OPENBLAS_CORETYPE": core},
        # A core that the processor has not would end in an illegal instruction.
        f'{X86} and "{flag}" in CPUINFO.read_text().split() and '
        f'all("{answers or core}" in found for found in blas_cores())',
        f"an x86-64 processor with {flag}, and OpenBLAS",
    )


def _threads(count: int) -> Machine:
    return Machine(
        f"OpenBLAS on {count} thread{'s' if count > 1 else ''}",
        {"OPENBLAS_NUM_THREADS": str(count)},
        f'all(core.endswith("threads: {count}") for core in blas_cores())',
        f"OpenBLAS and {count} cores",
    )


def _locale(what: str, name: str) -> Machine:
    return Machine(
        what,
        {"LC_ALL": name},
        'locale.setlocale(locale.LC_ALL, "")',
        f"the locale {name} (Debian: apt-get install locales-all)",
    )


def _python(version: str) -> Machine:
    name = f"python{version}"
    # A name may be there and refuse: pyenv's do, where another version was chosen.
    starts = f'not subprocess.run(["{name}", "-V"]).returncode'
    return Machine(f"Python {version}", holds=starts, needs=name, copy="tactus", python=name)


def _debian(version: str, name: str) -> Machine:
    return Machine(
        f"Debian {version}, with its Python, GHDL and Icarus",
        holds=f'platform.freedesktop_os_release().get("VERSION_ID") == "{version}"',
        needs=f"Debian {version}; run this in a container of debian:{name}, or in a folder that "
        f"debootstrap {name} has filled",
    )


MACHINES = {
    "default": Machine("nothing changed"),
    "numpy-avx2": _numpy("X86_V4"),
    "numpy-sse": _numpy("X86_V3", "X86_V4"),
    "openblas-prescott": _blas("Prescott", "sse2", answers="Katmai"),
    "openblas-haswell": _blas("Haswell", "avx2"),
    "openblas-skylakex": _blas("SkylakeX", "avx512f"),
    "glibc-sse": Machine(
        "glibc's mathematics without AVX2, FMA and AVX512",
        {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-AVX512F"},
        f'{X86} and platform.libc_ver()[0] == "glibc"',
        "an x86-64 processor and glibc",
    ),
    "one-thread": _threads(1),
    "two-threads": _threads(2),
    "hash-seed-1": Machine("order of sets", {"PYTHONHASHSEED": "1"}),
    "hash-seed-2": Machine("another order of sets", {"PYTHONHASHSEED": "2"}),
    "locale-c": _locale("no locale", "C"),
    "locale-german": _locale("decimal comma", "de_DE.UTF-8"),
    "locale-latin": _locale("letters that are not UTF-8", "de_DE.ISO-8859-1"),
    "locale-turkish": _locale("an i without a capital I", "tr_TR.UTF-8"),
    "time-zone": Machine("a date of its own", {"TZ": "Pacific/Chatham"}),
    "umask": Machine("files that nobody else may read", copy="tactus", umask=0o077),
    "path": Machine("a path with blanks and a letter beyond ASCII", copy="takt \u00fc s"),
    "sudo": Machine(
        "not root, sudo asks no password",
        holds=f'{OTHER_USER} and shutil.which("unshare") and shutil.which("sudo")',
        needs="root, sudo and unshare",
        copy="tactus",
        user="sudo",
    ),
    "no-sudo": Machine(
        "not root and no sudo", holds=OTHER_USER, needs="root", copy="tactus", user="no sudo"
    ),
    "lowest": Machine("the lowest versions that pyproject.toml allows", copy="tactus", lowest=True),
    "highest": Machine("the highest versions that pyproject.toml allows", copy="tactus"),
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
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--tests", default="", help="arguments of pytest instead of the selection")
    parser.add_argument("--simulated", action="store_true", help="the simulated tests too")
    parser.add_argument("--all", action="store_true", help="these, and what make test ALL=1 adds")
    parser.add_argument("--show", action="store_true", help="print what the tests print")
    arguments = parser.parse_args()
    for name in arguments.names:
        if name not in MACHINES:
            print(
                f"error: {name}: no such machine, expected {', '.join(MACHINES)}", file=sys.stderr
            )
            return 2
    tests = shlex.split(arguments.tests)
    if not tests and not (arguments.simulated or arguments.all):
        tests = [f"--deselect=tests/{name}" for name in SIMULATED]
    tests += ["--all"] if arguments.all else []
    results = [tell(name, tests, arguments.show) for name in arguments.names or MACHINES]
    if len(results) > 1:
        counts = [f"{results.count(word)} {word}" for word in ("passed", "failed", "not run")]
        print(f"machines: {', '.join(counts)}")
    if "failed" in results:
        return 1
    return 2 if arguments.names and "not run" in results else 0


def tell(name: str, tests: list[str], show: bool) -> str:
    """Run the tests as the machine of that name; print and return what came of it."""
    machine = MACHINES[name]
    if not is_possible(machine):
        print(f"not run  {name:18} needs {machine.needs}", flush=True)
        return "not run"
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
        last = text.decode(errors="replace").strip().rpartition("\n")[2].strip("= ")
        where = "" if passed else f"; see {log}"
        seconds = time.perf_counter() - started
        print(f"{word}   {name:18} {seconds:4.0f} s  {last}{where}", flush=True)
    return word


def is_possible(machine: Machine) -> bool:
    """Whether this machine can be that one: its condition holds in its environment."""
    imports = "import locale, os, platform, shutil, subprocess; from golden.machine import *"
    command = [sys.executable, "-c", f"{imports}\nassert {machine.holds}"]
    environment = os.environ | machine.environment
    return not subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, check=False
    ).returncode


def run(machine: Machine, tests: list[str], output: BinaryIO | None) -> int:
    """Run the tests as that machine; the exit code."""
    if not machine.copy:
        return call([sys.executable, "-m", "pytest", *CORES, *tests], ROOT, machine, output)
    with tempfile.TemporaryDirectory(prefix="tactus-") as name:
        home = Path(name)
        folder = home / machine.copy
        copy_checkout(folder, machine)
        words = [f"TESTS={shlex.join(tests)}", f"PYTHON={machine.python}", "VENV=.venv"]
        command = ["make", "--no-print-directory", "test", "MACHINE=", *words]
        if machine.lowest:
            command = ["sh", "-e", "-c", f"{LOWEST}\n{shlex.join(command)}"]
        if machine.user:
            command = as_nobody(command, home, machine.user == "sudo")
        return call(command, folder, machine, output)


def call(command: list[str], folder: Path, machine: Machine, output: BinaryIO | None) -> int:
    """The exit code of a command in the machine's environment."""
    # What this make was given is not for that of a copy.
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
    """The files of this checkout, as they are now, in ``folder``."""
    shutil.copytree(ROOT, folder, ignore=shutil.ignore_patterns(*NOT_COPIED))
    if machine.umask != -1:
        for path in (folder, *folder.rglob("*")):
            path.chmod(path.stat().st_mode & ~machine.umask)


def as_nobody(command: list[str], home: Path, sudo: bool) -> list[str]:
    """The command, run by the user nobody, who owns ``home``.

    With ``sudo``, sudo asks nobody for a password, in name spaces that end with the command.
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
    sys.exit(main())
