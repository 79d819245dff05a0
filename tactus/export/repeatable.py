"""Runs commands so that their output is the same bytes every time."""

import os
import sys
from collections.abc import Callable

from tactus.core.cli import run

# In the environment of a process whose output is the same on every run.
HASH_SEED = {"PYTHONHASHSEED": "0"}


def run_repeatable(module: str, main: Callable[[], int | None]) -> None:
    """Run a command's ``main`` and exit.

    MyHDL orders sensitivity lists by hash. So the command starts itself again with a fixed hash
    seed.
    """
    if os.environ | HASH_SEED != os.environ:
        os.environ.update(HASH_SEED)
        os.execv(sys.executable, [sys.executable, "-m", module, *sys.argv[1:]])
    sys.exit(run(main))
