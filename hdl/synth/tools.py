"""Runs Yosys and nextpnr, which come from PyPI, and keeps their answers in a store."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Callable, Iterable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from golden.files import read_kept, write_kept
from golden.fingerprint import fingerprint
from golden.folders import BUILD
from golden.input_error import InputError

STORE = BUILD / "synth"
# The exit codes of a process whose processor time was used up.
ENDED = (-signal.SIGXCPU, -signal.SIGKILL)


def run_tool(
    name: str,
    arguments: list[str],
    folder: Path,
    failing: bool = False,
    seconds: int | None = None,
) -> str:
    """Run ``yowasp-<name>`` in ``folder``, the only one that it sees, and return what it printed.

    With ``failing`` it may fail, and what it printed is returned even so. With ``seconds`` it may
    use only so much processor time; that it is stopped then is never an error.

    Raises
    ------
    InputError
        When the tool is not installed, or when it fails.
    """
    scripts = sysconfig.get_path("scripts")
    path = shutil.which(f"yowasp-{name}", path=scripts)
    if not path:
        raise InputError(
            f"not installed: yowasp-{name}; run: {sys.executable} -m pip install yowasp-{name}"
        )
    command = [path, *arguments]
    if seconds is not None:
        command = ["sh", "-c", 'ulimit -t "$0"; exec "$@"', str(seconds), *command]
    # A solver that the tool starts is installed beside it.
    environment = {**os.environ, "PATH": f"{scripts}{os.pathsep}{os.environ.get('PATH', '')}"}
    result = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    ended = seconds is not None and result.returncode in ENDED
    if result.returncode and not failing and not ended:
        last = (result.stdout + result.stderr).strip().splitlines()[-5:]
        raise InputError(f"yowasp-{name}: {' '.join(last)}")
    return result.stdout + result.stderr


def version_of(package: str) -> str:
    """The version of a package from PyPI.

    Raises
    ------
    InputError
        When the package is not installed.
    """
    try:
        return version(package)
    except PackageNotFoundError:
        raise InputError(
            f"not installed: {package}; run: {sys.executable} -m pip install {package}"
        ) from None


def digest(verilog: Path, names: Iterable[str] | None = None) -> str:
    """A digest of the code, without comments, of the ``.v`` files of a folder, or of some."""
    files = sorted(verilog.glob("*.v") if names is None else map(verilog.joinpath, names))
    return fingerprint([], *(f"{file.name}\n{_code(file.read_text())}" for file in files))


def _code(text: str) -> str:
    """Verilog without comments, empty lines and blanks at line ends."""
    lines = (line.partition("//")[0].rstrip() for line in text.splitlines())
    return "\n".join(line for line in lines if line)


def stored(
    work: Callable[[Path], dict[str, Any]], verilog: Path, tools: list[str], *facts: str
) -> dict[str, Any]:
    """What ``work`` makes of a copy of a folder's Verilog files, or the answer that was kept.

    Parameters
    ----------
    work : callable
        A function from a folder to something that JSON can hold.
    verilog : Path
        A folder with ``.v`` files.
    tools : list of str
        The packages on whose versions the answer depends.
    facts : str
        Everything else on which the answer depends.
    """
    scripts = sorted(Path(__file__).parent.glob("*.py"))
    key = fingerprint(scripts, digest(verilog), *facts, *map(version_of, tools))
    kept = STORE / f"{key}.json"
    found = read_kept(kept)
    if isinstance(found, dict):
        return found
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file in verilog.glob("*.v"):
            shutil.copy(file, folder)
        answer = work(folder)
    write_kept(kept, answer)
    return answer
