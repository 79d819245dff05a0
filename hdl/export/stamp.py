"""Whether what is exported is what would be exported now.

Words are a part of an export, which has the docstrings of its blocks as comments: so the text of
the sources enters, and not what they do alone.
"""

from __future__ import annotations

import platform
from functools import cache
from pathlib import Path

import myhdl

from golden import store
from golden.closure import closure
from golden.fingerprint import ROOT, fingerprint
from golden.scene import Scene


def is_current(scene: Scene, folder: Path) -> bool:
    """Whether the folder of a language holds what the scene gives with these sources."""
    return folder.is_dir() and store.read(*_asked(scene, folder)) == fingerprint([folder])


def write_stamp(scene: Scene, folder: Path) -> None:
    """Keep a digest of what the folder holds, under what it was exported from."""
    asked, build = _asked(scene, folder)
    store.write(asked, fingerprint([folder]), build)


def _asked(scene: Scene, folder: Path) -> tuple[store.Key, Path]:
    """The key of an export, and the folder for results that it is in."""
    asked = store.key(
        "export",
        scene=scene.name,
        language=folder.name,
        files=[*scene.files, ROOT / "golden" / "data"],
        sources=_sources(),
        tools=[f"myhdl {myhdl.__version__}", f"python {platform.python_version()}"],
    )
    return asked, folder.parents[1]


@cache
def _sources() -> str:
    return fingerprint(closure(["hdl.export.__main__"]).values())
