"""Pages contain what commands write into them, and the rest of a page stays as it is."""

import re
from pathlib import Path

import pytest
from pages import same_picture

from golden.input_error import InputError
from tactus.core.fingerprint import ROOT
from tactus.report.page import lists
from tactus.report.page.lists import END, begin, put
from tactus.report.page.made import MADE, MARK, scenes

pytestmark = pytest.mark.pages

HDL, SCENES = ROOT / "hdl", ROOT / "scenes"
PAGE = Path("page.md")
COMMAND = "python -m this"


def test_text_goes_between_its_own_markers() -> None:
    one, two = begin(COMMAND), begin(COMMAND, "second")
    page = f"# Page\n{one}\nold\n{END}\nbetween\n{two}\n{END}\nend\n"
    once = put(PAGE, page, "a", COMMAND)
    assert once == f"# Page\n{one}\n\na\n\n{END}\nbetween\n{two}\n{END}\nend\n"
    twice = put(PAGE, once, "b", COMMAND, "second")
    assert twice == f"# Page\n{one}\n\na\n\n{END}\nbetween\n{two}\n\nb\n\n{END}\nend\n"


@pytest.mark.parametrize(
    "page",
    [
        "# Page\n",
        f"{begin(COMMAND)}\n",
        f"{END}\n{begin(COMMAND)}\n",
        f"{begin(COMMAND)}\n{END}\n" * 2,
        f"{begin(COMMAND, 'another')}\n{END}\n",
    ],
)
def test_a_page_without_its_markers_once_each_is_refused(page: str) -> None:
    with pytest.raises(InputError, match=r"page\.md: expected the markers"):
        put(PAGE, page, "text", COMMAND)


def test_the_lists_are_those_of_the_project() -> None:
    for page, text in lists.pages().items():
        written = page.read_text(encoding="utf-8")
        same = same_picture(written, text) if page.suffix == ".svg" else written == text
        assert same, f"{page}: run: {lists.COMMAND}"


@pytest.mark.parametrize(
    ("other", "same"),
    [
        ('<path d="M 10.5 -3"/>', True),
        ('<path d="M 10.504 -3.001"/>', True),
        ('<path d="M 10.52 -3"/>', False),
        ('<path d="L 10.5 -3"/>', False),
        ('<path d="M 10.5 -3 4"/>', False),
    ],
)
def test_a_picture_is_the_same_where_nobody_sees_a_difference(other: str, same: bool) -> None:
    assert same_picture('<path d="M 10.5 -3"/>', other) == same


def test_pages_ask_for_all_that_is_made() -> None:
    texts = (page.read_text(encoding="utf-8") for page in (ROOT / "docs").rglob("*.md"))
    assert sorted(name for text in texts for name in MARK.findall(text)) == sorted(
        [*MADE, "commands"]
    )


def test_every_shipped_scene_is_listed() -> None:
    listed = re.findall(r"^\| `([\w/-]+)` \|", scenes(), re.M)
    files = {path.relative_to(SCENES).parent.as_posix() for path in SCENES.rglob("*.toml")}
    assert listed == sorted(n for n in files - {"data"} if not n.startswith("comparison/"))


def test_the_handover_page_names_every_design_that_can_be_the_top() -> None:
    page = (ROOT / "docs" / "handover.md").read_text(encoding="utf-8")
    sentence = page.partition("is the top entity:")[2].partition(".")[0]
    tops = {path.stem for room in ("networks", "instruments") for path in HDL.glob(f"{room}/*.py")}
    assert set(re.findall(r"`(\w+)`", sentence)) == tops - {"__init__"}


@pytest.mark.parametrize("name", ["error-against-run-time", "stability", "left-out", "thesis"])
def test_a_page_with_a_result_opens_with_a_picture_and_is_short(name: str) -> None:
    page = (ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8")
    shown = [line for line in page.splitlines() if line and not line.startswith("<!--")]
    assert [line[:2] for line in shown[:2]] == ["# ", "!["]
    assert len(page.split()) <= 900
