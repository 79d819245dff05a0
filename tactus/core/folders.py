"""Where results are written, and which files of tactus may be written.

A command writes below ``build`` in the user's current folder. In a checkout it may also write
beside the files that it was given, such as the networks of a shipped scene or the records of a
block. Files that pip has installed are not written, because an update would delete the results, and
several users may share these files.
"""

import os
from pathlib import Path

from golden.input_error import InputError
from tactus.core.fingerprint import ROOT

BUILD = Path("build")
ROOMS = ("golden", "hdl", "scenes", "tactus", "tb")


def is_checkout() -> bool:
    """Whether tactus runs from a checkout of its source; otherwise pip has installed it."""
    return (ROOT / "pyproject.toml").is_file()


def is_installed(path: Path) -> bool:
    """Whether a path is inside tactus as pip has installed it."""
    if is_checkout():
        return False
    place, root = (Path(os.path.realpath(p)) for p in (path, ROOT))
    return any(place.is_relative_to(root / room) for room in ROOMS)


def refuse_installed(path: Path) -> None:
    """Refuse to write a file that pip has installed."""
    if is_installed(path):
        raise InputError(
            f"{path}: cannot be written: it belongs to the installed package; expected a file of "
            "your own, or a checkout of tactus"
        )
