"""A copy of the project, in which a test types what a page says."""

from __future__ import annotations

import shutil
from pathlib import Path

ROOT = Path(__file__).parents[1]
# What Python writes while it compiles a module: it may be gone before it is copied.
UNFINISHED = shutil.ignore_patterns("*.pyc.*")


def copy_room(room: str, folder: Path) -> None:
    """Copy a room into a folder with what Python has compiled of it already."""
    shutil.copytree(ROOT / room, folder / room, ignore=UNFINISHED)
