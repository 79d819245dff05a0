"""The walk of docs/architecture.md is the one that a number takes, each module once."""

import re
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from types import FrameType, SimpleNamespace
from typing import Any

import pytest
from conftest import ROOT
from myhdl.conversion import _toVHDL

from tactus.cli.train import train_scene
from tactus.export.exporter import export
from tactus.scene import load_scene
from tactus.verify.benches.written import write_scene
from tb.common.cases import random_mlp

WALK = re.compile(r"^ ?\d+\. .*?\[(\w+)\]\(\.\./([\w/]+\.py)\)", re.M | re.S)


def returning(work: Callable[[], Any]) -> list[tuple[str, str]]:
    """The functions of the project, with their files, in the order in which they first return."""
    found: dict[tuple[str, str], None] = {}

    def look(frame: FrameType, event: str, _: object) -> None:
        code = frame.f_code
        if event == "return" and code.co_filename.startswith(str(ROOT)):
            found.setdefault((code.co_name, str(Path(code.co_filename).relative_to(ROOT))))

    sys.setprofile(look)
    try:
        work()
    finally:
        sys.setprofile(None)
    return list(found)


def test_the_walk_from_a_csv_file_to_vhdl(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    walk = WALK.findall(page.partition("## From a CSV file")[2].partition("\n## ")[0])
    assert len({file for _, file in walk}) == len(walk) <= 12
    mlp, chosen = random_mlp((2, 2, 1), 1.0, 1), {"design": "engine", "activation": "precise"}
    written = write_scene(tmp_path, "my", "exact", [mlp], **chosen)
    scene = partial(load_scene, str(written))
    # MyHDL takes away whatever looks on when it converts.
    monkeypatch.setattr(_toVHDL, "sys", SimpleNamespace(**vars(sys) | {"setprofile": bool}))
    trained = returning(lambda: train_scene(scene(), tmp_path, 1))
    exported = returning(lambda: export(scene(), "vhdl", tmp_path / "vhdl"))
    assert [one for one in trained if one in walk[:4]] == walk[:4]
    assert [one for one in exported if one in walk[4:]] == walk[4:]
