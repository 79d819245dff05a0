"""Runs commands so that their output is the same bytes every time."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable

from golden.cli import run


def run_repeatable(module: str, main: Callable[[], int | None]) -> None:
    """Run a command's ``main`` and exit.

    MyHDL orders sensitivity lists by hash. So the command starts itself again with a fixed hash
    seed.
    """
    if os.environ.get("PYTHONHASHSEED") != "0":
        os.environ["PYTHONHASHSEED"] = "0"
        os.execv(sys.executable, [sys.executable, "-m", module, *sys.argv[1:]])
    sys.exit(run(main))
