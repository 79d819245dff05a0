"""``python -m tactus.cli.set_up VENV``: makes an environment with everything that tactus needs, for
make.

It runs before anything is installed, so it imports only the standard library and modules that do
the same. It prints what pip prints, and a line every few seconds while pip is silent.
"""

import subprocess
import sys
from pathlib import Path

from tactus.core.cli import run
from tactus.core.progress import stage

# Pip does not always have a terminal, so it shows no colours and no progress bars.
PIP = ("-m", "pip", "--disable-pip-version-check", "--no-color", "install", "--progress-bar=off")
# Pip would compile on one core. Here all cores are used. What nothing here imports is left out, or
# only in small part: tests of packages, scapy, which cocotb-bus brings, pip itself, fontTools of
# matplotlib, and z3, which is started as a program. That is nearly half of all files. Mypy is
# compiled already.
WHAT = ("--no-compile", "-e", ".[dev]")
LEFT = "tests|scapy|pip|mypy|mypyc|setuptools|fontTools|z3"
COMPILE = ("-m", "compileall", "-qq", "-j", "0", "-x", rf"[/\\]({LEFT})[/\\]")


def main() -> int:
    venv = sys.argv[1]
    with stage(f"setting up {venv}"):
        made = subprocess.run([sys.executable, "-m", "venv", "--", venv], check=False)
    if made.returncode:
        return made.returncode
    with stage(f"installing into {venv} what pyproject.toml names"):
        python = str(Path(venv) / "bin" / "python")
        installed = subprocess.run([python, *PIP, *WHAT], check=False).returncode
        if installed == 0:
            # Some packages hold a file for another Python, which nobody imports.
            subprocess.run([python, *COMPILE, str(Path(venv) / "lib")], check=False)
        return installed


if __name__ == "__main__":
    sys.exit(run(main))
