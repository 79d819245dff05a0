"""Tells whether an export is current: whether a new one would give the same files.

An export holds the docstrings of its blocks as comments. So its key is made of the whole text of
the sources, and not only of their code.
"""

import platform
from functools import cache
from pathlib import Path

import myhdl

from tactus.core import store
from tactus.core.closure import closure
from tactus.core.fingerprint import ROOT, fingerprint
from tactus.scene import Scene


def is_current(scene: Scene, folder: Path) -> bool:
    """Whether the folder of a language holds what the scene gives with these sources."""
    return folder.is_dir() and store.read(*_asked(scene, folder)) == fingerprint([folder])


def write_stamp(scene: Scene, folder: Path) -> None:
    """Keep a digest of what the folder holds, under the key of what it was exported from."""
    asked, build = _asked(scene, folder)
    store.write(asked, fingerprint([folder]), build)


def _asked(scene: Scene, folder: Path) -> tuple[store.Key, Path]:
    """The key of an export, and the folder for results that it is in."""
    asked = store.key(
        "export",
        scene=scene.name,
        language=folder.name,
        files=[*scene.files, ROOT / "scenes" / "data"],
        sources=_sources(),
        tools=[f"myhdl {myhdl.__version__}", f"python {platform.python_version()}"],
    )
    return asked, folder.parents[1]


@cache
def _sources() -> str:
    templates = sorted(Path(__file__).parent.glob("*.jinja"))
    return fingerprint([*closure(["tactus.export.__main__"]).values(), *templates])
