"""A bad file is refused by one line that names it. The entries are in tests/refusals/."""

import os
import re
import shlex
import shutil
import tomllib
from pathlib import Path
from typing import Any

import onnx.parser
import pytest
from refused import Desk

from tactus.boards.board import FOLDER as BOARDS
from tactus.core.finding import faults
from tactus.physics.gauge_rig import FOLDER as RIGS
from tactus.scene import scene_path
from tactus.verify.benches.collected import CASES
from tactus.verify.benches.written import scene_of
from tactus.verify.check import check

FOLDER = Path(__file__).parent / "refusals"
READ = {path.stem: tomllib.loads(path.read_text("utf-8")) for path in FOLDER.glob("*.toml")}
TEXTS = {kind: read.pop("text", "").lstrip() for kind, read in READ.items()}
# The file of a base, and the command that reads a copy of it.
SHIPPED = {
    "ulx3s": (BOARDS / "ulx3s.toml", ["bitstream", "digit-board"]),
    "rig": (RIGS / "digit.toml", ["sensors"]),
}


def repeated(text: str) -> str:
    return re.sub("(.)…", lambda found: found[1] * 200_000, text)


def entries(kind: str) -> list[Any]:
    """The name of a base, a text of its file, what stands for it, and the words of the refusal."""
    return [
        pytest.param(base, old, repeated(new), words, id=ascii(f"{base}: {new or old}")[1:60])
        for base, edits in READ[kind].items()
        for old, changes in edits.items()
        for new, words in changes.items()
    ]


@pytest.mark.parametrize(("base", "old", "new", "words"), entries("scene"))
def test_a_scene_is_refused(
    desk: Desk, base: str, old: str, new: str, words: str | list[str]
) -> None:
    *call, name = ["bench", *base.split()][-2:]
    if name in CASES:
        scene_of(CASES[name], desk.folder, "mine")
    elif name != "mine":
        path = scene_path(name)
        shutil.copytree(path.parent, desk.folder, dirs_exist_ok=True)
        (desk.folder / path.name).rename("mine.toml")
    (desk.folder / "link.npz").symlink_to("mine.npz")
    (desk.folder / "loop").symlink_to("loop")
    desk.edit(old, new)
    desk.refuses(*call, "mine.toml", says=words)
    if isinstance(words, list):
        said = desk.call("bench", "mine.toml")[1].splitlines()
        assert [f"error: {text}" for text in faults(check("mine.toml", Path("build")))] == said


@pytest.mark.parametrize(("call", "old", "new", "words"), entries("readings"))
def test_readings_are_refused(desk: Desk, call: str, old: str, new: str, words: str) -> None:
    (desk.folder / "mine.csv").write_text(TEXTS["readings"])
    desk.edit(old, new, "mine.csv", "latin-1")
    desk.refuses(*shlex.split(call), says=words)


@pytest.mark.parametrize(("base", "old", "new", "words"), entries("shipped"))
def test_a_board_or_a_rig_is_refused(
    desk: Desk, base: str, old: str, new: str, words: str | list[str]
) -> None:
    path, call = SHIPPED[base]
    shutil.copy(path, "mine.toml")
    desk.edit(old, new)
    said = [words] if isinstance(words, str) else words
    desk.refuses(*call, "mine.toml", says=[f"mine.toml: {text}" for text in said])


@pytest.mark.parametrize(("form", "old", "new", "words"), entries("network"))
def test_a_network_is_refused(desk: Desk, form: str, old: str, new: str, words: str) -> None:
    text = TEXTS["network"]
    assert old in text
    model = onnx.parser.parse_model(text.replace(old, new))
    (desk.folder / f"mine.{form}").write_bytes(model.SerializeToString())
    desk.edit("mine.npz", f"mine.{form}")
    desk.edit("hidden = 5", "hidden = 0")
    desk.refuses("bench", "mine.toml", says=f"mine.{form}: .*{words}")


@pytest.fixture
def crowded(desk: Desk) -> Desk:
    """A desk with many files beside the scene that are not scenes."""
    (desk.folder / "folder.toml").mkdir()
    (desk.folder / "folder.npz").mkdir()
    (desk.folder / "loop.toml").symlink_to("loop.toml")
    (desk.folder / "device.toml").symlink_to("/dev/full")
    (desk.folder / "other").mkdir()
    for name in ("other.npz", "other.svg", "other/mine.npz"):
        (desk.folder / name).write_text("of the user", encoding="utf-8")
    for name in ("pipe", "pipe.npz", "pipe.toml"):
        os.mkfifo(desk.folder / name)
    scene = (desk.folder / "mine.toml").read_text(encoding="utf-8")
    (desk.folder / "untrained.toml").write_text(scene.replace("mine.npz", "no.npz"))
    (desk.folder / "latin.toml").write_bytes(b"# \xe9\n")
    (desk.folder / "binary.toml").write_bytes(bytes(99))
    return desk


@pytest.mark.parametrize(("call", "words"), READ["calls"]["calls"].items(), ids=ascii)
def test_a_call_is_refused(crowded: Desk, call: str, words: str) -> None:
    crowded.refuses(*shlex.split(repeated(call)), says=words)


@pytest.mark.parametrize(
    ("call", "name", "words"),
    [
        (call, *entry)
        for call, ways in READ["calls"]["in_the_way"].items()
        for entry in ways.items()
    ],
)
def test_what_stands_in_the_way_is_named(desk: Desk, call: str, name: str, words: str) -> None:
    scene_of(CASES["rails-reload"], desk.folder, "loaded")
    path = desk.folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    if name.endswith("/"):
        path.unlink(missing_ok=True)
        path.mkdir()
    else:
        path.touch()
    desk.refuses(*call.split(), says=words)
    assert path.exists()
