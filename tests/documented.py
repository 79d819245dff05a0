"""The commands that the pages name, in code and in a line: of make, of tactus, and of Python."""

from __future__ import annotations

import re
import shlex
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from golden.network_files.network_file import save_network
from golden.scene import load_scene
from golden.table import read_table, write_table
from tb.commands import BY_NAME, Command
from tb.common.cases import random_mlp

ROOT = Path(__file__).parents[1]
PAGES = sorted([ROOT / "README.md", *(ROOT / "docs").rglob("*.md")])
# The change log names commands as they were.
PAGES = [page for page in PAGES if page.stem != "changelog"]
# Variables of the shell, or a folder of programs, may stand in front.
BEGIN = r"(?:[A-Z_]+=\S+ )*(make [a-z]|tactus [a-z]|(?:\S+/)?python3? -m )"
FIRST_WORD = re.compile(BEGIN)
FRONT_DOORS = ("make", "tactus")
# Stand-ins for what a user has and this project has not, by variable and by what the pages show.
STAND_INS = {
    ("SCENE", "path/to/rig.toml"): "tutorial/rig.toml",
    ("SCENE", "../rig/my-rig.toml"): "digit",
    ("SCENE", "my-rig.toml"): "digit",
    ("SCENE", "mine.toml"): "digit-board",
    ("SCENE", "my-digit/digit.toml"): "digit",
    ("SCENE", "scratch/digit-relu.toml"): "digit-hybrid",
    ("SCENE", "scratch/digit-rowwise.toml"): "digit-hybrid",
    # What the pages about new blocks and designs add: their own tests type it in and run it.
    ("BLOCK", "relu"): "precise",
    ("BLOCK", "rowwise"): "hybrid",
    ("TESTS", "tests/test_relu.py"): "tests/test_precise.py",
    ("LABELS", "placements.csv"): "labels.csv",
    ("CSV", "path/to/readings.csv"): "tutorial/readings.csv",
    ("CSV", "path/to/new.csv"): "tutorial/new.csv",
    ("CSV", "all.csv"): "new.csv",
    ("TO", "readings.csv"): "written/readings.csv",
    ("TO", "path/to/rig.toml"): "written/rig.toml",
    ("TO", "path/to/out.csv"): "written/out.csv",
    ("OUTPUTS", "a,b"): "load,position",
}


@dataclass(frozen=True)
class Documented:
    """A command of a page, as it stands there, and where it stands first."""

    text: str
    page: Path

    @property
    def words(self) -> list[str]:
        """Its words, without the variables of the shell in front, in quotes or not."""
        found = shlex.split(re.sub(r"\[[^]]*\]", "", self.text))
        while "=" in found[0]:
            found = found[1:]
        return found

    @property
    def command(self) -> Command | None:
        """The command of the table that it is; None for another program."""
        return BY_NAME.get(self.words[1]) if self.words[0] in FRONT_DOORS else None

    @property
    def shown(self) -> dict[str, str]:
        """The variables that it gives. ``SCENE=`` and ``SCENE=...`` stand for any."""
        of = _given_to_tactus if self.words[0] == "tactus" else _given_to_make
        pairs = (of(word) for word in self.words[2:])
        return {name: value for name, value in pairs if value not in ("", "...")}

    @property
    def optional(self) -> list[str]:
        """The variables that it shows in brackets."""
        return re.findall(r"\[([A-Z]+)=", self.text)

    @property
    def variables(self) -> dict[str, str]:
        """The variables that it is tried with.

        What the pages only show is a stand-in, and so is what the command needs and a sentence
        leaves out.
        """
        assert self.command
        needed = {a.name: a.example for a in self.command.arguments if a.needed}
        return {n: STAND_INS.get((n, v), v) for n, v in (needed | self.shown).items()}


def _given_to_make(word: str) -> tuple[str, str]:
    name, _, value = word.partition("=")
    return name, value


def _given_to_tactus(word: str) -> tuple[str, str]:
    """A variable by the name that it has in the table."""
    if not word.startswith("--"):
        return "SCENE", word
    name, _, value = word[2:].partition("=")
    return name.upper(), value or "1"


def documented() -> list[Documented]:
    """Every command of every page, once."""
    found: dict[str, Documented] = {}
    for page in PAGES:
        for text in commands_of(page.read_text(encoding="utf-8")):
            found.setdefault(text, Documented(text, page))
    return list(found.values())


def commands_of(page: str) -> Iterator[str]:
    """The commands of a page in their order: lines of code, and what stands between backticks."""
    fences = r"^(?:```+|~~~+).*?^(?:```+|~~~+)$"
    for block in re.findall(fences, page, re.M | re.S):
        for line in block.splitlines():
            yield from _command(line.strip().removeprefix("$ "))
    for paragraph in re.sub(fences, "\n", page, flags=re.M | re.S).split("\n\n"):
        for line in paragraph.splitlines():
            if line.startswith("    "):
                yield from _command(line.strip().removeprefix("$ "))
        for span in re.findall(r"`([^`]+)`", paragraph):
            yield from _command(" ".join(span.split()))


def _command(text: str) -> Iterator[str]:
    """The text, if it is a command; what stands apart behind it is a remark."""
    if FIRST_WORD.match(text):
        yield re.split(r" {2,}", text)[0]


def lay_out(folder: Path) -> None:
    """Files of a user, with the names that the pages give them, and the folders that are read."""
    for name in ("golden", "docs", "tests"):
        (folder / name).symlink_to(ROOT / name)
    shutil.copytree(ROOT / "docs" / "tutorial", folder / "tutorial")
    # As after make train, which takes a minute.
    for n, member in enumerate(load_scene(str(folder / "tutorial" / "rig.toml")).members):
        save_network(member.weights_path, random_mlp((member.inputs, 4, 1), 1.0, n), {})
    (folder / "written").mkdir()
    shutil.copy(ROOT / "golden" / "physics" / "rigs" / "digit.toml", folder / "my-beam.toml")
    sensors = [f"sensor{n}" for n in range(1, 5)]
    outputs = ["load", "position", "width", "shape"]
    table = read_table(ROOT / "golden" / "data" / "appendix2.csv", sensors + outputs)
    # Of sensors that have drifted: of others nothing is written.
    drifted = table * [0.95, 1, 0.95, 1, 1, 1, 1, 1]
    write_table(folder / "placements.csv", sensors + outputs, drifted, 4)
    write_table(folder / "labels.csv", outputs, table[:, 4:], 4)
    write_table(folder / "readings.csv", [*sensors, *outputs[:2]], table[:, :6], 4)
    write_table(folder / "new.csv", sensors, np.asarray(table[:, :4]), 4)
