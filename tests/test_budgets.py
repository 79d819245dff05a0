"""The rooms of the house hold no more than their budgets in pyproject.toml."""

import re
import subprocess
import tomllib
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
BUDGET = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["tactus"][
    "budget"
]
# A title that is underlined: sections repeat types and list exceptions, which signatures and
# ``InputError`` say.
SECTION = re.compile(r"^ *(Parameters|Attributes|Returns|Raises|Notes)\n *-{3,}$", re.M)


@cache
def files() -> list[Path]:
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    paths = [ROOT / name for name in listed.stdout.split("\0") if name]
    return [path for path in paths if path.is_file()]


def count(endings: set[str], room: str = ".", words: bool = False) -> int:
    texts = (
        path.read_text(encoding="utf-8")
        for path in files()
        if path.suffix in endings and path.is_relative_to(ROOT / room)
    )
    return sum(len(text.split() if words else text.splitlines()) for text in texts)


def test_there_are_no_more_files() -> None:
    assert len(files()) <= BUDGET["files"]


def test_pages_have_no_more_words() -> None:
    assert count({".md"}, words=True) <= BUDGET["words"]
    assert all(len(p.read_text("utf-8").split()) <= 2500 for p in ROOT.glob("docs/**/*.md"))


def test_there_are_no_more_records() -> None:
    assert count({".csv", ".json"}) <= BUDGET["records"]


@pytest.mark.parametrize("room", BUDGET["lines"])
def test_a_room_has_no_more_lines(room: str) -> None:
    assert count({".py"}, room) <= BUDGET["lines"][room]


def test_docstrings_say_what_signatures_do_not() -> None:
    found = [path for path in files() if path.suffix == ".py" and SECTION.search(path.read_text())]
    assert found == []
