"""Runs Yosys and nextpnr, which come from PyPI, and keeps their answers in the store."""

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

from golden.input_error import InputError
from tactus.core import store
from tactus.core.closure import code
from tactus.core.fingerprint import fingerprint

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
    try:
        return version(package)
    except PackageNotFoundError:
        raise InputError(
            f"not installed: {package}; run: {sys.executable} -m pip install {package}"
        ) from None


def digest(folder: Path, names: Iterable[str] | None = None) -> str:
    """A digest of the code in the ``.v`` files of a folder, or in some files, without comments."""
    files = sorted(folder.glob("*.v") if names is None else map(folder.joinpath, names))
    return fingerprint([], *(f"{file.name}\n{_code(file)}" for file in files))


def _code(file: Path) -> str:
    """Verilog or VHDL without comments, empty lines and blanks at line ends."""
    mark = "--" if file.suffix == ".vhd" else "//"
    text = file.read_text(encoding="utf-8")
    lines = (line.partition(mark)[0].rstrip() for line in text.splitlines())
    return "\n".join(line for line in lines if line)


def stored(
    work: Callable[[Path], dict[str, Any]],
    verilog: Path,
    tools: list[str],
    **facts: store.Part,
) -> dict[str, Any]:
    """What ``work`` makes of a copy of a folder's Verilog files, or the answer that was kept.

    work: A function from a folder to something that JSON can hold. The code of its module is part
        of the key.
    verilog: A folder with ``.v`` files.
    tools: The packages on whose versions the answer depends.
    facts: Everything else on which the answer depends.
    """
    asked = store.key(
        "synthesis",
        verilog=digest(verilog),
        tools=[f"{name} {version_of(name)}" for name in tools],
        scripts=code([__name__, work.__module__], _asks),
        **facts,
    )

    def answer() -> dict[str, Any]:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            for file in verilog.glob("*.v"):
                shutil.copy(file, folder)
            return work(folder)

    found: dict[str, Any] = store.cached(asked, answer)
    return found


def _asks(importer: str, imported: str) -> bool:
    """Whether a module may call the tools, as those in the same package do."""
    package = imported.rpartition(".")[0]
    return package in ("tactus.synth", importer.rpartition(".")[0])
