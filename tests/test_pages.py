"""Pages contain what commands write into them and the figures that are measured."""

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from pages import ROUNDING, cells, same_picture, section, shows
from scipy.signal import find_peaks
from shared import Shared

from golden.activation.abs_unit import AbsUnit
from golden.input_error import InputError
from golden.numbers.precision import EXACT, SIGNAL, THESIS
from studies.physics.swing_data import independent_run
from tactus.cli.listing import adders as listing
from tactus.core.commands import BY_NAME
from tactus.errors import disturbed_errors, held_out_means, noises_of, scene_errors
from tactus.physics.gauges import load_rig
from tactus.report.measure.networks import clocks_per_frame
from tactus.report.measure.outcome import outcome
from tactus.report.measure.table import Table
from tactus.report.page import lists, summary
from tactus.report.page.blocks import port_table
from tactus.report.page.lists import END, begin, put
from tactus.report.page.made import MADE, MARK
from tactus.scene import load_scene, thesis_figures, thesis_table
from tactus.scene.disturbance import Disturbance
from tactus.synth.budget import read_budget
from tactus.synth.cells import KINDS
from tactus.synth.lean import cells as synthesised

pytestmark = pytest.mark.pages

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


@pytest.mark.all_only
@pytest.mark.usefixtures("yosys")
def test_the_whole_of_the_rebuilt_networks_takes_the_luts_of_the_page() -> None:
    whole = load_scene(lists.REBUILT).twin(lean=False)
    assert synthesised(whole, "xc2v")["LUT"] == lists.WHOLE


def test_a_format_stands_with_its_precision() -> None:
    twins = [(AbsUnit(one.hidden_fmt), one.name) for one in (EXACT, THESIS)]
    (data,) = [line for line in port_table(twins).splitlines() if line.startswith("| `in_data`")]
    assert "| exact: Fix(18,14); thesis: Fix(14,13) |" in data
    (data,) = [line for line in port_table(twins[:1]).splitlines() if "`in_data` |" in line]
    assert "| Fix(18,14) |" in data


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


def test_the_first_table_of_a_report_holds_the_errors() -> None:
    scene = load_scene("digit")
    found, held_out = scene_errors(scene), held_out_means(scene)
    noisy = [disturbed_errors(scene, Disturbance(noise)) for noise in noises_of(scene)]
    thesis = thesis_figures(scene.reference, len(scene.outputs), scene.path)
    table = summary.errors(outcome(scene))
    noises = [f"noise {noise:g}, %" for noise in noises_of(scene)]
    assert list(table.columns) == [
        *("output", "held out %", "mean %", "largest %", "worst %", *noises),
        *("float %", "thesis %"),
    ]
    for n, (name, *figures) in enumerate(table.rows):
        real, bit_true = (found[kind][n] for kind in ("float", "bit-true"))
        expected = [held_out[n], bit_true.mean, bit_true.largest_mean, bit_true.worst]
        expected += [*(errors[n] for errors in noisy), real.mean, thesis[n]]
        assert name == scene.outputs[n]
        assert figures == pytest.approx(expected)


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


FORMS = ("single", "multiple", "cascade")


def displacement_errors(results: np.ndarray, actual: np.ndarray) -> list[float]:
    """Equation 6.6: mean errors in percent of the mean way from end to end of a swing.

    The thesis calls the divisor "actual total displacement", without an equation. Here it is the
    mean of the motion's peaks minus that of its troughs.
    """
    ends = [[x[find_peaks(sign * x)[0]].mean() for sign in (1, -1)] for x in actual.T]
    return list(100 * np.abs(results - actual).mean(axis=0) / [high - low for high, low in ends])


def errors_of_motions(name: str, runs: tuple[int, ...]) -> dict[str, float]:
    """Equation 6.6 for each output of a shipped scene, bit-true, in the worst of the runs."""
    scene = load_scene(name)
    found = []
    for run in runs:
        inputs = scene.window.frames(independent_run(run, scene.sensors))
        actual = independent_run(run, scene.outputs)[scene.window.past :]
        codes = scene.twin().core.process(SIGNAL.quantise(inputs)[0])
        exact = displacement_errors(SIGNAL.to_real(codes), actual)
        real = displacement_errors(scene.process_real(inputs), actual)
        # In the thesis' 14 bits the activation is trained with, and differs from floating point.
        pairs = zip(exact, real, strict=True)
        assert name.endswith("-thesis") or all(abs(a - b) < 0.03 for a, b in pairs)
        found.append(exact)
    return dict(zip(scene.outputs, np.max(found, axis=0).tolist(), strict=True))


@pytest.mark.all_only
def test_the_motions_of_the_page_are_those_measured() -> None:
    """The page shows the worse of two bit-true runs beside the thesis, and the demanded error."""
    page = section("physics", "Networks for the swing")
    for n, name in enumerate(("swing-window", "swing-window-cascade")):
        # The last two runs were made after the networks were chosen.
        for m, runs in enumerate(((1, 2), (3, 4))):
            found = errors_of_motions(name, runs)
            for output, asked in zip("xyz", (1.5, 0.2, 1.0), strict=True):
                shown = cells(page, f"{output}, with a past")
                assert shows(shown[2 * n + m], found[output], ROUNDING), (name, output)
                assert found[output] <= asked
    for n, form in enumerate(FORMS):
        printed = thesis_table("swing")[form]["percent_error"]
        for scene, row in (
            (f"swing-{form}", "{}"),
            (f"comparison/swing-{form}-thesis", "{}, 14 bits"),
        ):
            found = errors_of_motions(scene, (1, 2))
            for c, output in enumerate("xyz"):
                shown = cells(page, row.format(output))
                assert shows(shown[2 * n], found[output], ROUNDING), (scene, output)
                assert float(shown[2 * n + 1]) == printed[c]


def test_a_table_as_text() -> None:
    table = Table("t", ["name", "value"], [["long name", 1.23456], ["x", None], ["y", 12]], "Why.")
    body = ["name       value", "long name  1.235", "x              -", "y             12"]
    assert table.lines() == ["t", "", *body, "", "Why."]


def test_a_page_rounds_a_column_alike_unless_it_has_several_units() -> None:
    rows = [[0.4061, 116.7, 248, 0.9999], [1.018, 3.42, 3.875, 0.5]]
    assert Table("t", ["%", "MHz", "all", "part"], rows, "").shown == [
        ["0.41", "116.7", "248", "0.9999"],
        ["1.02", "3.4", "3.88", "0.5000"],
    ]


def test_the_gauges_of_the_page_are_those_found() -> None:
    page = section("limits", "Where gauges should sit")
    rig = load_rig("digit")
    cases = [("thesis", rig, list(rig.compare))]
    cases += [("best found", replace(rig, count=count), []) for count in (3, 4, 6)]
    cases.append(("best found", replace(rig, count=4, cell_noise=math.inf), []))
    for label, case, known in cases:
        places = known or case.best()
        cell = "yes" if math.isfinite(case.cell_noise) else "no"
        mm = ", ".join(f"{1e3 * place:.4g}" for place in places)
        means = case.errors(places).mean(axis=0)
        for text, mean in zip(cells(page, label, str(len(places)), cell, mm), means, strict=True):
            assert shows(text, float(mean), ROUNDING)


def test_a_cascade_pays_clocks_for_accuracy() -> None:
    """No part of the error is promised in advance. The figures of the page are those measured.

    The networks of the thesis have the hidden nodes that it prints, so a cascade wins less there.
    """

    def largest(name: str) -> float:
        return max(error.largest_mean for error in scene_errors(load_scene(name))["bit-true"])

    def frame(name: str) -> str:
        return str(clocks_per_frame(load_scene(name).twin()))

    page = " ".join(section("thesis", "Clocks for accuracy").split())
    pairs = {"digit-hybrid": "digit-single", "digit-thesis": "digit-single-thesis"}
    for cascade, single in pairs.items():
        form = rf"`{cascade}` takes (\d+) clocks .*?by ([\d.]+) times .*?`{single}`.*? (\d+)"
        (shown,) = re.findall(form, page)
        part = largest(cascade) / largest(single)
        assert shown == (frame(cascade), f"{part:.2f}", frame(single))
        assert part < 1
    assert largest("digit-a") > largest("digit-hybrid")
    assert largest("digit-thesis-a") > largest("digit-thesis")
