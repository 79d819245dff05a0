"""A bad file is refused by one line that names it. The entries are in tests/refusals/."""

import re
import shutil
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from refused import Desk

from tactus.core.finding import faults
from tactus.scene import scene_path
from tactus.verify.benches.collected import CASES
from tactus.verify.check import check

FOLDER = Path(__file__).parent / "refusals"


def entries(kind: str) -> Iterator[Any]:
    """The name of a base, a text of its file, what stands for it, and the words of the refusal."""
    known = tomllib.loads((FOLDER / f"{kind}.toml").read_text(encoding="utf-8"))
    for base, edits in known.items():
        for old, changes in edits.items():
            for new, words in changes.items():
                text = re.sub("(.)…", lambda found: found[1] * 200_000, new)
                yield pytest.param(base, old, text, words, id=ascii(f"{base}: {new or old}")[1:60])


@pytest.mark.parametrize(("base", "old", "new", "words"), entries("scene"))
def test_a_scene_is_refused(
    desk: Desk, base: str, old: str, new: str, words: str | list[str]
) -> None:
    if base in CASES:
        CASES[base].scene(desk.folder, "mine")
    elif base != "mine":
        path = scene_path(base)
        shutil.copytree(path.parent, desk.folder, dirs_exist_ok=True)
        (desk.folder / path.name).rename("mine.toml")
    (desk.folder / "link.npz").symlink_to("mine.npz")
    (desk.folder / "loop").symlink_to("loop")
    desk.edit(old, new)
    desk.refuses("bench", "mine.toml", says=words)
    if isinstance(words, list):
        said = desk.call("bench", "mine.toml")[1].splitlines()
        assert [f"error: {text}" for text in faults(check("mine.toml", Path("build")))] == said
