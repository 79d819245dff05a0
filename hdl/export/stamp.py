"""Tells whether an export is current: whether a new one would give the same files."""

from __future__ import annotations

import platform
from pathlib import Path

import myhdl

from golden.files import writing
from golden.fingerprint import fingerprint, sources
from golden.scene import Scene


def is_current(scene: Scene, folder: Path) -> bool:
    """Whether the folder of a language holds what the scene gives with these sources."""
    stamp = _stamp(folder)
    return (
        stamp.is_file()
        and folder.is_dir()
        and stamp.read_text(encoding="utf-8", errors="replace") == _state(scene, folder)
    )


def write_stamp(scene: Scene, folder: Path) -> None:
    """Write down what the folder was exported from, and what it holds."""
    with writing(_stamp(folder)):
        _stamp(folder).write_text(_state(scene, folder), encoding="utf-8")


def _stamp(folder: Path) -> Path:
    return folder.parent / f".{folder.name}.stamp"


def _state(scene: Scene, folder: Path) -> str:
    """A digest of all inputs and outputs; a change of either asks for a new export."""
    inputs = [*sources("golden", "hdl"), *scene.files, folder]
    return fingerprint(inputs, myhdl.__version__, platform.python_version())
