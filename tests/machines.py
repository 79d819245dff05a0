"""``make test MACHINE=``: the tests as on a machine of the nightly workflow's matrix.

A machine of the matrix is this computer with other variables, another place of the checkout,
another user, or other versions.
"""

import locale
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import yaml

from golden.input_error import InputError
from golden.machine import blas_cores, numpy_targets, possible_settings

ROOT = Path(__file__).parents[1]
WORKFLOW = ROOT / ".github" / "workflows" / "machines.yml"
# These do not belong to the project: what .gitignore names, and the folder of git.
NOT_COPIED = (".git", ".venv*", "build", "*.egg-info", "__pycache__", ".*_cache", ".hypothesis")
# An instruction set of numpy has a name by level, and an older one.
OLDER_NAMES = {"X86_V3": "AVX2", "X86_V4": "AVX512"}


@dataclass(frozen=True)
class Machine:
    """An entry of the matrix.

    machine: The name.
    what: What is other.
    group: The group of tests.
    env: Variables of the environment.
    folder: The folder for a copy of the checkout with its own environment, or empty for no copy.
    run: Commands of the shell that run the tests.
    image: The container of the nightly workflow, which alone reads this and the next one.
    may_fail: Whether the workflow passes even if this machine fails.
    """

    machine: str
    what: str
    group: str
    env: Mapping[str, str] = field(default_factory=dict)
    folder: str = ""
    run: str = "make test"
    image: str = "debian:bookworm"
    may_fail: bool = False


def machines() -> dict[str, Machine]:
    """The machines by name."""
    jobs = yaml.safe_load(WORKFLOW.read_text(encoding="utf-8"))["jobs"]
    entries = jobs["machine"]["strategy"]["matrix"]["include"]
    return {entry["machine"]: Machine(**entry) for entry in entries}


def machine_of(name: str) -> Machine:
    """The machine of that name."""
    known = machines()
    if name not in known:
        raise InputError(f"MACHINE={name}: no such machine, expected {', '.join(known)}")
    return known[name]


def run_on(machine: Machine, group: str) -> int:
    """Run the tests of a group as that machine, and return the exit code.

    What a user gave to make stands in the environment, where the make of the machine finds it.
    """
    for name, value in machine.env.items():
        # A library reads its variables once, so another process must say what they do.
        command = [sys.executable, __file__, name, value]
        environment = os.environ | machine.env
        if subprocess.run(command, env=environment, capture_output=True, check=False).returncode:
            raise InputError(
                f"MACHINE={machine.machine}: {name}={value} has no effect on this computer, "
                "expected one that docs/verification.md describes"
            )
    # MACHINE is not passed on, nor are the variables of this make.
    kept = {k: v for k, v in os.environ.items() if k != "MACHINE" and not k.startswith("MAKE")}
    environment = {**kept, **machine.env, "GROUP": group}
    if not machine.folder:
        return call(machine.run, ROOT, environment)
    with tempfile.TemporaryDirectory(prefix="tactus-") as home:
        folder = Path(home) / machine.folder
        shutil.copytree(ROOT, folder, ignore=shutil.ignore_patterns(*NOT_COPIED))
        return call(machine.run, folder, {**environment, "VENV": ".venv"})


def call(commands: str, folder: Path, environment: Mapping[str, str]) -> int:
    """Run commands of the shell up to the first that fails, and return the exit code."""
    return subprocess.run(
        ["sh", "-ec", commands], cwd=folder, env=environment, stdin=subprocess.DEVNULL, check=False
    ).returncode


def has_effect(name: str, value: str) -> bool:
    """Whether this process, which was started with the variable, behaves as the variable says."""
    match name:
        case "LC_ALL":
            locale.setlocale(locale.LC_ALL, "")
        case "PYTHON":
            # A program of this name may exist and fail, as those of pyenv do if another version
            # is chosen.
            return subprocess.run([value, "-V"], check=False).returncode == 0
        case "NPY_DISABLE_CPU_FEATURES":
            unwanted = [name for level in value.split() for name in (level, OLDER_NAMES[level])]
            return not any(name in target for name in unwanted for target in numpy_targets())
        case "OPENBLAS_CORETYPE":
            # The processor may lack what the core needs, and the name Prescott gives Katmai.
            core = "Katmai" if value == "Prescott" else value
            possible = {name: value} in possible_settings().values()
            return possible and all(core in found for found in blas_cores())
        case "OPENBLAS_NUM_THREADS":
            return all(found.endswith(f"threads: {value}") for found in blas_cores())
        case "GLIBC_TUNABLES":
            return platform.machine() == "x86_64" and platform.libc_ver()[0] == "glibc"
    return True


if __name__ == "__main__":
    sys.exit(not has_effect(*sys.argv[1:]))
