"""Modules that run, and the walk of docs/architecture.md: the one that a number takes."""

import ast
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


@pytest.mark.parametrize("room", ["golden", "hdl", "studies", "tactus", "tb"])
def test_a_module_that_runs_ends_with_its_start(room: str) -> None:
    """What is defined behind the start does not exist yet when it is needed."""
    for path in (ROOT / room).rglob("*.py"):
        body = ast.parse(path.read_text(encoding="utf-8")).body
        starts = [
            n
            for n, one in enumerate(body)
            if isinstance(one, ast.If) and "__main__" in ast.unparse(one.test)
        ]
        assert not starts or starts == [len(body) - 1], path


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
