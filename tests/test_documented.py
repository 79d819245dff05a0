"""Tries every command that a page names, as the page shows it, and builds the site.

A command is called as ``make`` calls it, with ``DRY=1``: it checks its arguments, says what it
would do, and does nothing. The tutorials really run them. ``test_make.py`` tests that make passes
its variables on. Every run reads the guides and the datasheets, and resolves their links. ALL=1
builds the whole site, with a page for each file that a guide links to.
"""

import re
import shlex
import shutil
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from urllib.parse import unquote, urlsplit

import numpy as np
import pytest
from pages import HtmlPage
from refused import main_of
from shared import Shared, run
from test_census import ROOT
from test_make import here

from tactus.core.cli import run as run_main
from tactus.core.commands import BY_NAME, Command
from tactus.core.table import read_table, write_table
from tactus.network_files.network_file import save_network
from tactus.scene import load_scene
from tb.common.cases import random_mlp

pytestmark = pytest.mark.pages

PAGES = sorted([ROOT / "README.md", *(ROOT / "docs").rglob("*.md")])
# The change log is left out, because it names commands as they were.
PAGES = [page for page in PAGES if page.stem != "changelog"]
# Variables of the shell, or a folder of programs, may come first.
BEGIN = r"(?:[A-Z_]+=\S+ )*(make [a-z]|tactus [a-z]|(?:\S+/)?python3? -m )"
FIRST_WORD = re.compile(BEGIN)
FRONT_DOORS = ("make", "tactus")
# The pages show values that only a user has. For each, this names a value that a test can use.
STAND_INS = {
    ("SCENE", "my-rig/rig.toml"): "tutorial/rig.toml",
    ("SCENE", "my-rig/board.toml"): "digit-board",
    ("SCENE", "my-rig.toml"): "digit",
    ("SCENE", "mine.toml"): "digit-board",
    ("SCENE", "my-digit/digit.toml"): "digit",
    ("SCENE", "scratch/digit-relu.toml"): "digit-hybrid",
    ("SCENE", "scratch/digit-rowwise.toml"): "digit-hybrid",
    # The pages on new blocks and designs add these. Tests of their own type them in and run them.
    ("BLOCK", "relu"): "precise",
    ("BLOCK", "rowwise"): "hybrid",
    ("LABELS", "placements.csv"): "labels.csv",
    ("CSV", "my-rig/readings.csv"): "tutorial/readings.csv",
    ("CSV", "all.csv"): "new.csv",
    ("TO", "readings.csv"): "written/readings.csv",
    ("TO", "my-rig/rig.toml"): "written/rig.toml",
    ("TO", "my-rig/out.csv"): "written/out.csv",
    ("OUTPUTS", "a,b"): "load,position",
}
# Of these pairs of variables a command needs one.
EITHER = {"scene": ("OUTPUTS", "CLASSES")}


@dataclass(frozen=True)
class Documented:
    """A command as a page shows it, and the first page that does."""

    text: str
    page: Path

    @property
    def words(self) -> list[str]:
        """The words of the command, without variables of the shell before it."""
        found = shlex.split(re.sub(r"\[[^]]*\]", "", self.text))
        while "=" in found[0]:
            found = found[1:]
        return found

    @property
    def command(self) -> Command | None:
        """The entry of the table of commands, or None for another program."""
        return BY_NAME.get(self.words[1]) if self.words[0] in FRONT_DOORS else None

    @property
    def shown(self) -> dict[str, str]:
        """The variables that the page gives. ``SCENE=`` and ``SCENE=...`` stand for any value."""
        of = _given_to_tactus if self.words[0] == "tactus" else _given_to_make
        pairs = (of(word) for word in self.words[2:])
        return {name: value for name, value in pairs if value not in ("", "...")}

    @property
    def optional(self) -> list[str]:
        """The variables that the page shows in brackets."""
        return re.findall(r"\[([A-Z]+)=", self.text)

    @property
    def variables(self) -> dict[str, str]:
        """The variables with which a test tries the command.

        A stand-in replaces each value that only a user has, and each required value that the
        sentence leaves out.
        """
        one_of = EITHER.get(self.command.name, ())
        first = () if self.shown.keys() & set(one_of) else one_of[:1]
        needed = {a.name: a.example for a in self.command.arguments if a.needed or a.name in first}
        return {n: STAND_INS.get((n, v), v) for n, v in (needed | self.shown).items()}


def _given_to_make(word: str) -> tuple[str, str]:
    name, _, value = word.partition("=")
    return name, value


def _given_to_tactus(word: str) -> tuple[str, str]:
    """A variable, with its name in the table of commands."""
    if not word.startswith("--"):
        return "SCENE", word
    name, _, value = word[2:].partition("=")
    return name.upper(), value or "1"


def documented() -> list[Documented]:
    """Every command of every page, each once."""
    found: dict[str, Documented] = {}
    for page in PAGES:
        for text in commands_of(page.read_text(encoding="utf-8")):
            found.setdefault(text, Documented(text, page))
    return list(found.values())


def commands_of(page: str) -> Iterator[str]:
    """The commands of a page in their order, from lines of code and from backticks."""
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
    """The command in a text, if it is one, without a remark after several blanks."""
    if FIRST_WORD.match(text):
        yield re.split(r" {2,}", text)[0]


def lay_out(folder: Path) -> None:
    """Make the files of a user, under the names of the pages, and the folders that are read."""
    for name in ("docs", "scenes", "tactus", "tests"):
        (folder / name).symlink_to(ROOT / name)
    shutil.copytree(ROOT / "docs" / "tutorial", folder / "tutorial")
    # These files are what make train would write in a minute.
    for n, member in enumerate(load_scene(str(folder / "tutorial" / "rig.toml")).members):
        save_network(member.weights_path, random_mlp((member.inputs, 4, 1), 1.0, n), {})
    (folder / "written").mkdir()
    shutil.copy(ROOT / "tactus" / "physics" / "rigs" / "digit.toml", folder / "my-beam.toml")
    sensors = [f"sensor{n}" for n in range(1, 5)]
    outputs = ["load", "position", "width", "shape"]
    table = read_table(ROOT / "scenes" / "data" / "appendix2.csv", sensors + outputs)
    # The sensors have drifted, because otherwise no correction is written.
    drifted = table * [0.95, 1, 0.95, 1, 1, 1, 1, 1]
    write_table(folder / "placements.csv", sensors + outputs, drifted, 4)
    write_table(folder / "labels.csv", outputs, table[:, 4:], 4)
    write_table(folder / "readings.csv", [*sensors, *outputs[:2]], table[:, :6], 4)
    rows = [
        f"{','.join(map(str, row))},{'tap' if n % 2 else 'hold'}" for n, row in enumerate(table)
    ]
    names = ",".join([*sensors, *outputs, "gesture"])
    (folder / "gestures.csv").write_text("\n".join([names, *rows, ""]), encoding="utf-8")
    write_table(folder / "new.csv", sensors, np.asarray(table[:, :4]), 4)


# Make does these itself. With DRY=1 its recipes say what they would do.
OWN = ("docs", "pages", "lint", "clean")
# Calls that the page before has in other words.
TRIED: set[tuple[str, ...]] = set()
SAYS = "DRY=1: nothing done; would "


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a user who has all files that the pages name."""
    folder = tmp_path_factory.mktemp("user")
    lay_out(folder)
    return folder


def words_of(item: Documented) -> tuple[str, list[str]]:
    """The module that a command calls, and its words."""
    if item.command is None:
        assert item.words[1] == "-m", item.text
        module, *words = [word for word in item.words[2:] if word != "tactus.cli.call"]
        return module, words
    if item.command.module:
        _, _, module, *words = item.command.words(item.variables)
        return module, words
    given = item.variables
    words = [f"--tests={given.get('TESTS', '')}"]
    chosen = [
        *([f"--block={given['BLOCK']}"] if "BLOCK" in given else []),
        *(["--pages"] if "PAGES" in given else []),
    ]
    return "chosen", [*chosen, *words]


def call(item: Documented, folder: Path, monkeypatch: pytest.MonkeyPatch) -> int:
    """Call a command in a folder, and return its exit code."""
    module, words = words_of(item)
    main = main_of(module)
    monkeypatch.chdir(folder)
    monkeypatch.setattr(sys, "argv", [module, *words])
    try:
        return run_main(main)
    except SystemExit as stop:
        return stop.code if isinstance(stop.code, int) else 1


@pytest.mark.parametrize("item", documented(), ids=lambda item: item.text)
def test_a_documented_command_works(item: Documented, place: Path, monkeypatch, capfd) -> None:
    where = f"{item.page.relative_to(ROOT)}: {item.text}"
    if item.words[0] in FRONT_DOORS:
        assert item.command, f"{where}: no such command"
        known = {argument.name for argument in item.command.arguments}
        assert {*item.shown, *item.optional} <= known, f"{where}: expected {', '.join(known)}"
        if item.command.name in OWN:
            return
    given = item.variables.get("TESTS", "").split() if item.command else []
    for name in takewhile(lambda word: not word.startswith("-"), given):
        assert (ROOT / name).is_file(), f"{where}: no such test"
    module, words = words_of(item)
    if (module, *words) in TRIED:
        return
    TRIED.add((module, *words))
    monkeypatch.setenv("DRY", "1")
    before = sorted(place.rglob("*"))
    code = call(item, place, monkeypatch)
    said = capfd.readouterr()
    assert code == 0, f"{where}\n{said.err}"
    if not (item.command and item.command.name == "check"):
        assert SAYS in said.out, where
    assert sorted(place.rglob("*")) == before


def broken_links(site: Path) -> list[str]:
    """Every link to a missing file or anchor. Links to other sites are left out."""
    pages = {
        path.resolve(): HtmlPage(path.read_text(encoding="utf-8"))
        for path in sorted(site.rglob("*.html"))
    }
    found = []
    for path, page in pages.items():
        for link in sorted({*page.links}):
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            missing = not target.is_file() or not target.is_relative_to(site.resolve())
            anchor = unquote(parts.fragment)
            if missing or (anchor and anchor not in pages[target].anchors):
                found.append(f"{path.relative_to(site.resolve())}: {link}")
    return found


def test_site_guides_can_be_read_and_their_links_lead_somewhere(tmp_path: Path) -> None:
    """No page is written."""
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "dummy"]
    places = ["-d", tmp_path / "doctrees", ROOT / "docs", tmp_path / "site"]
    result = run(*command, *places)
    assert result.returncode == 0, result.stderr


@pytest.mark.all_only
def test_site_is_complete_and_every_link_leads_somewhere(shared: Shared) -> None:
    (Path(sys.prefix) / ".ready").touch()
    site = shared.folder / "docs" / "site"
    result = here("docs", f"SITE={site}")
    assert result.returncode == 0, result.stderr
    assert [path.name for path in site.parent.iterdir()] == ["site"]
    assert not broken_links(site)
    start = HtmlPage((site / "index.html").read_text("utf-8"))
    assert "the-blocks" in start.anchors
    for guide in (ROOT / "docs").glob("*.md"):
        assert (site / f"{guide.stem}.html").is_file()
        assert f"{guide.stem}.html" in start.links or guide.stem == "index"
    slips = (site / "slips.html").read_text(encoding="utf-8")
    assert "sigma_6 = 0.633" in slips
    for path in site.rglob("*"):
        if path.is_file():
            content = path.read_bytes()
            assert str(ROOT).encode() not in content, path
            assert str(site.parent).encode() not in content, path
