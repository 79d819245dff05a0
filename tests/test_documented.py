"""Tries every command that a page names, as the page shows it. A command that fails is an error.

A command is called as ``make`` calls it, with ``DRY=1``: it checks its arguments, says what it
would do, and does nothing. The tutorials really run them.
``test_make.py`` tests that make passes its variables on.
"""

import sys
from itertools import takewhile
from pathlib import Path

import pytest
from documented import FRONT_DOORS, ROOT, Documented, documented, lay_out
from refused import main_of

from tactus.core.cli import run

pytestmark = [
    pytest.mark.pages,
    pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning"),
]

FOUND = documented()
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
        _, option, module, *words = item.words
        assert option == "-m", item.text
        return module, words
    if item.command.module:
        _, module, *words = item.command.words(item.variables)
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
        return run(main)
    except SystemExit as stop:
        return stop.code if isinstance(stop.code, int) else 1


@pytest.mark.parametrize("item", FOUND, ids=lambda item: item.text)
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
