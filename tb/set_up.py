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


def main() -> int:
    venv = sys.argv[1]
    with stage(f"setting up {venv}"):
        made = subprocess.run([sys.executable, "-m", "venv", "--", venv], check=False)
    if made.returncode:
        return made.returncode
    with stage(f"installing into {venv} what pyproject.toml names"):
        python = str(Path(venv) / "bin" / "python")
        return subprocess.run([python, *PIP, "-e", ".[dev]"], check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
