"""Compares the documentation with the project: links, port tables, and commands."""

import re
from pathlib import Path

import pytest
from pages import ROUNDING, cells, shows

from golden.networks.designs import DESIGNS
from golden.networks.left_out import left_out
from tactus.cli.demo import error_table
from tactus.core.commands import BY_NAME
from tactus.errors.scene_errors import disturbed_errors, held_out_means, noises_of, scene_errors
from tactus.scene import load_scene, thesis_figures
from tactus.scene.disturbance import Disturbance
from tactus.synth.budget import read_budget
from tactus.synth.netlist import KINDS

pytestmark = [
    pytest.mark.pages,
    pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning"),
]

ROOT = Path(__file__).parents[1]
PAGES = sorted([ROOT / "README.md", ROOT / "CHANGELOG.md", *(ROOT / "docs").rglob("*.md")])
SHEETS = sorted((ROOT / "docs" / "blocks").glob("*.md"))
HEADINGS = ["Diagram", "Behaviour"]
OPTIONAL = ["Numeric behaviour", "Limits"]


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_links_lead_somewhere(page: Path) -> None:
    text = re.sub(r"```.*?```", "", page.read_text(), flags=re.S)
    for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", text):
        if not target.startswith(("http:", "https:", "mailto:")):
            assert (page.parent / target).exists(), f"{page.name} links to {target}"


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
    assert held_out is not None
    for n, name in enumerate(scene.outputs):
        kinds = [errors[kind][n] for kind in ("float", "bit-true")]
        figures = [figure for e in kinds for figure in (e.mean, e.largest_mean, e.worst)]
        figures += [held_out[n], *(errors[n] for errors in noisy), thesis[n]]
        for text, figure in zip(cells(printed, name), figures, strict=True):
            assert shows(text, figure, ROUNDING), name


def test_the_scenes_page_names_the_designs_that_go_with_a_section() -> None:
    page = (ROOT / "docs" / "scenes.md").read_text(encoding="utf-8")
    streams = [f"`{name}`" for name, design in DESIGNS.items() if design.stream == "serial"]
    for name in ("front_end", "visualisation"):
        section = page.partition(f"### [{name}]\n")[2].partition("\n#")[0]
        assert f"The design must be {' or '.join(streams)}, which" in section


def test_the_scenes_page_shows_what_a_scene_leaves_out() -> None:
    """The page shows the texts of the twin and the recorded cells."""
    page = (ROOT / "docs" / "scenes.md").read_text(encoding="utf-8")
    first, *others = re.search(r"make lean SCENE=(\S+) BESIDE=(\S+)`", page).groups()
    shown = page.partition(f"\nscene {first} leaves out:\n")[2].partition("\n```")[0]
    texts, _, table = shown.partition("\n\n")
    assert [line.strip() for line in texts.splitlines()] == left_out(load_scene(first).twin())
    for name in (first, *others):
        scene = load_scene(name)
        recorded = read_budget(scene.path)["xc2v"][scene.twin().entity]
        assert cells(table, name) == [str(recorded[kind]) for kind in KINDS]
    whole, found = (cells(table, *start) for start in ((f"{first},", "whole"), (first,)))
    saved = [str(int(a) - int(b)) for a, b in zip(whole, found, strict=True)]
    assert cells(table, "saved") == saved
