"""A virtual environment with the packages of other projects, apart from ours."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

from golden.files import replace_file
from golden.fingerprint import fingerprint
from golden.input_error import InputError

REQUIREMENTS = Path(__file__).with_name("requirements.txt")
READY = ".ready"


def installed(folder: Path) -> Path:
    """The Python of an environment in ``folder`` with the packages of ``requirements.txt``.

    The environment is made if it is not there, or if the requirements have changed.

    Raises
    ------
    InputError
        When pip cannot install them, because there is no network or no wheel for this machine.
    """
    python, ready = folder / "bin" / "python", folder / READY
    wanted = fingerprint([REQUIREMENTS], sys.version)
    if python.exists() and ready.is_file() and ready.read_text(encoding="utf-8") == wanted:
        return python
    print(f"setting up {folder}", flush=True)
    run([sys.executable, "-m", "venv", "--clear", str(folder)])
    pip = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    try:
        run([*pip, "--only-binary", "da4ml", "--requirement", str(REQUIREMENTS)])
    except InputError as error:
        names = ", ".join(line for line in _lines() if not line.startswith("#"))
        raise InputError(
            f"{names}: not installed; make peers needs a network and a wheel for this machine, "
            f"which da4ml has for x86-64 Linux and for macOS on ARM\n{error}"
        ) from None
    with replace_file(ready) as temporary:
        temporary.write_text(wanted, encoding="utf-8")
    return python


def _lines() -> list[str]:
    return REQUIREMENTS.read_text(encoding="utf-8").split("\n")[:-1]


def version_of(python: Path, package: str) -> str:
    """The version of a package in an environment."""
    listed = run([str(python), "-m", "pip", "list", "--format", "json"])
    versions = {entry["name"]: entry["version"] for entry in json.loads(listed)}
    return str(versions[package])


def run_isolated(python: Path, program: Path, given: dict[str, Any], folder: Path) -> Any:
    """Run a program with the Python of another environment, and return its answer.

    Question and answer are JSON files in ``folder``; the programs describe them.

    Raises
    ------
    InputError
        When the program fails.
    """
    (folder / "given.json").write_text(json.dumps(given), encoding="utf-8")
    # The program runs isolated, so that it sees nothing of this project.
    run([str(python), "-I", str(program), str(folder)])
    return json.loads((folder / "answer.json").read_text(encoding="utf-8"))


def run(command: list[str], folder: Path | None = None) -> str:
    """Run a program and return what it printed.

    Raises
    ------
    InputError
        When the program fails; the message has its last lines.
    """
    result = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if result.returncode:
        last = (result.stdout + result.stderr).strip().splitlines()[-5:]
        raise InputError(f"{Path(command[0]).name}: " + "\n".join(last))
    return result.stdout
