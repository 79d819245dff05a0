"""Virtual environments with the packages of other projects, apart from ours."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from tactus.core.files import replace_file
from tactus.core.fingerprint import fingerprint

REQUIREMENTS = Path(__file__).with_name("requirements.txt")
READY = ".ready"
# This is written in part in C++. Without a wheel pip would try to compile them.
WHEELS = "alkaid"


def pinned(package: str) -> str:
    """The version of a package in ``requirements.txt``."""
    lines = REQUIREMENTS.read_text(encoding="utf-8").split()
    return dict(line.split("==") for line in lines)[package]


def installed(folder: Path, package: str) -> Path:
    """The Python of an environment in ``folder`` with a package of ``requirements.txt``.

    The environment is made if it is not there, or if another version is required now.
    """
    requirement = f"{package}=={pinned(package)}"
    python, ready = folder / "bin" / "python", folder / READY
    wanted = fingerprint([], requirement, sys.version)
    if python.exists() and ready.is_file() and ready.read_text(encoding="utf-8") == wanted:
        return python
    print(f"setting up {folder}", flush=True)
    run([sys.executable, "-m", "venv", "--clear", str(folder)])
    pip = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    try:
        run([*pip, "--only-binary", WHEELS, requirement])
    except InputError as error:
        raise InputError(
            f"{requirement}: not installed; this needs a network, and a wheel for this machine if "
            f"the package is one of {WHEELS}\n{error}"
        ) from None
    with replace_file(ready) as temporary:
        temporary.write_text(wanted, encoding="utf-8")
    return python


def run_isolated(python: Path, program: Path, given: dict[str, Any], folder: Path) -> Any:
    """Run a program with the Python of another environment, and return its answer.

    Question and answer are JSON files in ``folder``; the programs describe them.
    """
    (folder / "given.json").write_text(json.dumps(given), encoding="utf-8")
    # The program runs isolated, so that it sees nothing of this project.
    run([str(python), "-I", str(program), str(folder)])
    return json.loads((folder / "answer.json").read_text(encoding="utf-8"))


def run(command: list[str], folder: Path | None = None) -> str:
    """Run a program and return what it printed."""
    name = Path(command[0]).name
    try:
        result = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    except FileNotFoundError:
        raise InputError(f"not installed: {name}") from None
    if result.returncode:
        last = (result.stdout + result.stderr).strip().splitlines()[-5:]
        raise InputError(f"{name}: " + "\n".join(last))
    return result.stdout
