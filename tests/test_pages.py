"""Pages contain what commands write into them, and the rest of a page stays as it is."""

import re
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from pages import ROUNDING, cells, same_picture, shows
from shared import Shared

from golden.input_error import InputError
from tactus.cli.demo import error_table
from tactus.cli.listing import adders as listing
from tactus.core.commands import BY_NAME
from tactus.errors import disturbed_errors, held_out_means, noises_of, scene_errors
from tactus.report.page import lists
from tactus.report.page.lists import END, begin, put
from tactus.report.page.made import MADE, MARK
from tactus.scene import load_scene, thesis_figures
from tactus.scene.disturbance import Disturbance
from tactus.synth.budget import read_budget
from tactus.synth.cells import KINDS

pytestmark = [
    pytest.mark.pages,
    pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning"),
]

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


def test_pages_ask_for_all_that_is_made() -> None:
    texts = (page.read_text(encoding="utf-8") for page in (ROOT / "docs").rglob("*.md"))
    assert sorted(name for text in texts for name in MARK.findall(text)) == sorted(
        [*MADE, "commands"]
    )


@pytest.mark.parametrize("name", ["digit-fast", "three-graph", "relu-graph"])
def test_a_listing_computes_what_the_matrix_does(shared: Shared, name: str) -> None:
    rng = np.random.default_rng(1)
    for matrix in shared.scene(name).twin().core.layers:
        frames = rng.integers(matrix.in_fmt.low, matrix.in_fmt.high + 1, (50, matrix.inputs))
        names = {f"in_data_{k}": frames[:, k] for k in range(matrix.inputs)}
        for line in listing(matrix)[2:]:
            name, _, what = line.split(maxsplit=2)
            names[name] = eval(what, {"__builtins__": {}}, names)
        results = [names[f"out_data_{i}"] for i in range(len(matrix.weights))]
        # A row without weights is a constant.
        found = np.stack([np.broadcast_to(one, len(frames)) for one in results], axis=-1)
        low, high = matrix.out_fmt.low, matrix.out_fmt.high
        assert np.array_equal(np.clip(found, low, high), matrix.process(frames))


ROOMS = [ROOT / "docs", ROOT / "studies"]
PAGES = sorted([*ROOT.glob("*.md"), *(page for room in ROOMS for page in room.rglob("*.md"))])
SHEETS = sorted((ROOT / "docs" / "blocks").glob("*.md"))
HEADINGS = ["Diagram", "Behaviour"]
OPTIONAL = ["Numeric behaviour", "Limits"]


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_links_lead_somewhere(page: Path) -> None:
    text = re.sub(r"```.*?```", "", page.read_text(), flags=re.S)
    for target, anchor in re.findall(r"\]\(([^)#\s]+)#?([^)]*)\)", text):
        if not target.startswith(("http:", "https:", "mailto:")):
            assert (page.parent / target).exists(), f"{page.name} links to {target}"
            if anchor and target.endswith(".md"):
                assert anchor in anchors(page.parent / target), f"{page.name}: {target}#{anchor}"


def anchors(page: Path) -> list[str]:
    """Those that GitHub gives the headings of a page."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(), re.M)
    return [re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings]


def test_the_change_log_names_commands_that_there_are() -> None:
    """test_documented.py tries the commands of the other pages."""
    text = (ROOT / "CHANGELOG.md").read_text()
    for name in re.findall(r"(?:^|`)make ([a-z]+)", text, re.M):
        assert name in {*BY_NAME, "help", "tools"}, name


# The block that new-block.md adds does not exist here, nor does the design of new-design.md.
@pytest.mark.parametrize(
    "page",
    [page for page in PAGES if page.stem not in ("new-block", "new-design")],
    ids=lambda p: str(p.relative_to(ROOT)),
)
def test_tests_that_are_named_exist(page: Path) -> None:
    """A page names a test as `file`: `function`, `function`."""
    named = re.findall(r"`((?:tests|tb)/[\w/]+\.py)`:((?:,?\s+`\w+`)+)", page.read_text())
    for file, functions in named:
        text = (ROOT / file).read_text()
        for function in re.findall(r"\w+", functions):
            assert re.search(rf"\b{function}\b", text), f"{page.name} names {file}: {function}"


@pytest.mark.parametrize("sheet", SHEETS, ids=lambda p: p.stem)
def test_a_blocks_page_has_its_headings_in_order_and_is_short(sheet: Path) -> None:
    """Diagrams, waveforms, formulas and tables are not counted as words."""
    text = sheet.read_text()
    found = re.findall(r"^## (.+)$", text, re.M)
    assert found == HEADINGS + [heading for heading in OPTIONAL if heading in found]
    lines = re.sub(r"```.*?```", "", text, flags=re.S).splitlines()
    prose = [line for line in lines if not line.startswith(("|", "    ", "!", "<!--"))]
    assert sum(len(line.split()) for line in prose) <= 250


def test_the_demos_table_holds_the_errors() -> None:
    scene = load_scene("digit")
    printed = "\n".join(error_table(scene))
    errors, held_out = scene_errors(scene), held_out_means(scene)
    noisy = [disturbed_errors(scene, Disturbance(noise)) for noise in noises_of(scene)]
    thesis = thesis_figures(scene.reference, len(scene.outputs), scene.path)
    for n, name in enumerate(scene.outputs):
        kinds = [errors[kind][n] for kind in ("float", "bit-true")]
        figures = [figure for e in kinds for figure in (e.mean, e.largest_mean, e.worst)]
        figures += [held_out[n], *(errors[n] for errors in noisy), thesis[n]]
        for text, figure in zip(cells(printed, name), figures, strict=True):
            assert shows(text, figure, ROUNDING), name


def test_the_scenes_page_shows_what_a_scene_leaves_out() -> None:
    """The page shows the texts of the twin and the recorded cells."""
    page = (ROOT / "docs" / "scenes.md").read_text(encoding="utf-8")
    first, *others = re.search(r"make lean SCENE=(\S+) BESIDE=(\S+)`", page).groups()
    shown = page.partition(f"\nscene {first} leaves out:\n")[2].partition("\n```")[0]
    texts, _, table = shown.partition("\n\n")
    assert [line.strip() for line in texts.splitlines()] == load_scene(first).twin().left_out()
    for name in (first, *others):
        scene = load_scene(name)
        recorded = read_budget(scene.path)["xc2v"][scene.twin().entity]
        assert cells(table, name) == [str(recorded[kind]) for kind in KINDS]
    whole, found = (cells(table, *start) for start in ((f"{first},", "whole"), (first,)))
    saved = [str(int(a) - int(b)) for a, b in zip(whole, found, strict=True)]
    assert cells(table, "saved") == saved


WALK = re.compile(r"^ ?\d+\. .*?\[(\w+)\]\(\.\./([\w/]+\.py)\)", re.M | re.S)


def test_the_walk_from_a_csv_file_to_vhdl_names_functions_of_its_files() -> None:
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    walk = WALK.findall(page.partition("## From a CSV file")[2].partition("\n## ")[0])
    assert 8 <= len(walk) <= 12
    for name, file in walk:
        assert re.search(rf"^ *def {name}\(", (ROOT / file).read_text("utf-8"), re.M), name
