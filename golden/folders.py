"""Where results go, and what of tactus may be written.

A command writes below ``build`` of the folder in which the user stands. In a checkout it may also
write beside what it was given, such as the networks of a shipped scene or what is recorded of a
block. What pip has installed is not written: an update would lose it, and several users may share
it.
"""

from __future__ import annotations

import os
from pathlib import Path

from golden.fingerprint import ROOT
from golden.input_error import InputError

BUILD = Path("build")
ROOMS = ("golden", "hdl", "tb")


def is_checkout() -> bool:
    """Whether tactus stands in a checkout of its source; otherwise pip has installed it."""
    return (ROOT / "pyproject.toml").is_file()


def is_installed(path: Path) -> bool:
    """Whether a path leads into tactus as pip has installed it."""
    if is_checkout():
        return False
    place, root = (Path(os.path.realpath(p)) for p in (path, ROOT))
    return any(place.is_relative_to(root / room) for room in ROOMS)


def refuse_installed(path: Path) -> None:
    """Refuse to write what pip has installed.

    Raises
    ------
    InputError
    """
    if is_installed(path):
        raise InputError(
            f"{path}: cannot be written: it belongs to the installed package; expected a file of "
            "your own, or a checkout of tactus"
        )
