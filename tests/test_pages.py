"""Pages contain what commands write into them, and the rest of a page stays as it is."""

import re
from pathlib import Path

import numpy as np
import pytest
from pages import TRAINED, same_picture, shows

from golden.fingerprint import ROOT
from golden.input_error import InputError
from golden.physics.beam import Beam
from golden.physics.bound import least_deviations, slopes_by_codes
from golden.physics.digit_data import RECORDED, SENSORS
from golden.physics.strain_sensor import COLUMNS, fit_sensors
from golden.scene import load_scene
from golden.scene_errors import held_out_means, held_out_rows
from golden.table import read_table
from golden.training.split import split_of
from tb.report.measure import table_records
from tb.report.page import lists, sign_off
from tb.report.page.markers import END, begin, put

pytestmark = pytest.mark.pages

HDL, SCENES = ROOT / "hdl", ROOT / "golden" / "scenes"
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


def test_what_is_recorded_stands_in_the_page_of_all_blocks() -> None:
    for page, text in sign_off.pages().items():
        assert page.read_text(encoding="utf-8") == text, f"{page}: run: {sign_off.COMMAND}"


def test_the_readme_says_what_held_out_does_not() -> None:
    """The text is beside the errors of the digit. Its figures are those of other pages."""
    scene = load_scene("digit")
    text = " ".join(lists.unseen().split())
    rows = table_records.read("honest").rows
    for output in ("width", "shape"):
        error = next(row[2] for row in rows if row[:2] == ["loads", output])
        found = re.search(rf"{output} (?:that errs )?by (\d+ to \d+) %", text)
        assert found, output
        # Another machine may measure figures outside of the range, as test_figures_honest.py says.
        assert shows(found[1], error, TRAINED), output
    table = read_table(RECORDED, [*SENSORS, *COLUMNS])
    loads = table[:, len(SENSORS) :]
    noise = np.full(len(SENSORS), 0.002)
    least = least_deviations(slopes_by_codes(fit_sensors(table, Beam()), loads), noise)
    silent = int(np.isinf(least[:, COLUMNS.index("width")]).sum())
    assert f"at {silent} of {len(table)} placements no sensor feels the width" in text
    split = split_of(scene)
    trained = {tuple(row) for row in loads[split.training][:, [0, 2, 3]]}
    assert {tuple(row) for row in loads[split.test][:, [0, 2, 3]]} <= trained
    # The shipped networks were trained on with all rows, so no row is held out.
    assert held_out_rows(scene) is None
    assert held_out_means(scene) is not None


def test_every_shipped_scene_is_listed() -> None:
    listed = re.findall(r"^\| `([\w/-]+)` \|", lists.scenes(), re.M)
    files = {path.relative_to(SCENES).parent.as_posix() for path in SCENES.rglob("*.toml")}
    assert listed == sorted(name for name in files if not name.startswith("comparison/"))


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
