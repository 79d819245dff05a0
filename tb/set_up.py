"""``python -m tb.set_up VENV``: an environment with all that tactus needs, which make asks for.

It runs before anything is installed, so it imports nothing but the standard library and what does
so too. What pip prints is printed, and where pip is silent a line every few seconds.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from golden.progress import stage

# Colours and bars are for a terminal that pip does not always have.
PIP = ("-m", "pip", "--disable-pip-version-check", "--no-color", "install", "--progress-bar=off")
# Pip compiles on one core what is compiled here on all of them.
WHAT = ("--no-compile", "-e", ".[dev]")
COMPILE = ("-m", "compileall", "-qq", "-j", "0")


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
            # Of some packages a file is for another Python, and nobody imports it.
            subprocess.run([python, *COMPILE, str(Path(venv) / "lib")], check=False)
        return installed


if __name__ == "__main__":
    sys.exit(main())
