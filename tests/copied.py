"""Copies for tests: of the project, in which a test types what a page says, and of scenes."""

import re
import shutil
from pathlib import Path

ROOT = Path(__file__).parents[1]
# What Python writes while it compiles a module: it may be gone before it is copied.
UNFINISHED = shutil.ignore_patterns("*.pyc.*")


def copy_room(room: str, folder: Path) -> None:
    """Copy a room into a folder with what Python has compiled of it already."""
    shutil.copytree(ROOT / room, folder / room, ignore=UNFINISHED)


def movable(path: Path) -> str:
    """The text of a scene, which names its data and its weights wherever it is written to."""
    return re.sub(
        r'"([^"\n]+\.(?:csv|npz))"',
        lambda found: f'"{(path.parent / found[1]).resolve()}"',
        path.read_text(),
    )
