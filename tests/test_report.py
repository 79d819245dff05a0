"""Tests the report of a scene: its content, its pictures, the files beside it, and its look."""

import csv
import json
import re
import shutil
from itertools import combinations
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextToPath
from pages import HtmlPage
from shared import Shared, browse

from golden.common.block import walk
from golden.numbers.precision import SIGNAL
from tactus.core.fingerprint import ROOT
from tactus.report.draw import run_time
from tactus.report.draw.datapath import datapath
from tactus.report.draw.load import drawn, load_profile
from tactus.report.draw.named import SIZE
from tactus.report.draw.network import network
from tactus.report.draw.svg import ACCENT
from tactus.report.measure.networks import clocks_per_frame
from tactus.report.measure.table import Table
from tactus.report.page import build
from tactus.report.page.content import Page, Section, pictures
from tactus.report.page.made import design_picture
from tactus.report.page.summary import frame as frame_table
from tactus.scene import load_scene, scene_names
from tactus.scene.reading import scene_path
from tactus.verify.benches.collected import CASES
from tactus.verify.benches.runner import BUILD
from tactus.verify.benches.written import scene_of

OWN = "reported"
DATA = ROOT / "scenes" / "data" / "appendix2.csv"
WIDTHS = {"phone": 390, "desktop": 1280}


@pytest.fixture(scope="module")
def own(shared: Shared) -> Path:
    """The report of a user's scene without reference, and with a network that was not trained here.

    No other test may use the name of this scene, because all commands of a run share a folder.
    """
    folder = shared.folder / OWN

    def make() -> None:
        folder.mkdir()
        shutil.copy(scene_path("digit-single").with_suffix(".npz"), folder / f"{OWN}.npz")
        shutil.copy(DATA, folder)
        text = scene_path("digit-single").read_text().replace("digit-single", OWN)
        text = re.sub(r"reference = .*\n", "", text).replace("../data/", "")
        (folder / f"{OWN}.toml").write_text(text)
        build.build_report(load_scene(str(folder / f"{OWN}.toml")))

    with shared.own_store():
        shared.once("own report", make)
    return (BUILD / OWN / "report.html").resolve()


@pytest.fixture(scope="module")
def own_data(own: Path) -> dict:
    return json.loads((own.with_suffix("") / "report.json").read_text())


def test_a_users_report_is_about_the_users_scene(own: Path, own_data: dict) -> None:
    wanted = {"errors", "costs", "worst_rows", "confidence", "along", "noise_and_drift"}
    wanted |= {"sensors", "sensors_tell", "designs", "frame", "errors_in_units"}
    assert set(own_data["tables"]) == wanted
    predicted = {f"predicted_{c}" for c in range(4)}
    disturbed = {f"disturbed_{kind}" for kind in ("noise", "gain", "offset")}
    drawn = {"along", "designs", "network", "datapath"}
    assert set(own_data["pictures"]) == {*predicted, *disturbed, *drawn}
    assert "thesis" not in own.read_text().lower()


def test_the_commands_of_a_users_report_name_its_file(own: Path, own_data: dict) -> None:
    text = json.dumps(own_data)
    commands = re.findall(r"make (?:demo|designs|synth|sim)[^.;]*?(?:RECORD=1|SCENE=\S+)", text)
    assert {command.split()[1] for command in commands} >= {"designs", "synth"}
    for command in commands:
        assert re.search(rf"SCENE=/\S*/{OWN}\.toml", command), command


def test_the_worst_rows_are_those_of_the_file(own_data: dict) -> None:
    table = own_data["tables"]["worst_rows"]
    with DATA.open(newline="") as handle:
        file = list(csv.DictReader(handle))
    worst = {row[0]: row[4] for row in own_data["tables"]["errors"]["rows"]}
    for name, number, *values in table["rows"]:
        cells = dict(zip(table["columns"][2:], values, strict=True))
        recorded = file[number - 1]
        assert [cells[f"sensor{k}"] for k in range(1, 5)] == [
            float(recorded[f"sensor{k}"]) for k in range(1, 5)
        ]
        assert cells["recorded"] == float(recorded[name])
        scale = 0.9 if name in ("position", "width") else cells["recorded"]
        error = 100 * abs(cells["computed"] - cells["recorded"]) / scale
        assert cells["error %"] == pytest.approx(error)
        assert cells["error %"] <= worst[name]
    for name in worst:
        assert max(row[-1] for row in table["rows"] if row[0] == name) == worst[name]


def test_the_page_needs_nothing_beside_it_and_every_anchor_leads_somewhere(own: Path) -> None:
    text = own.read_text()
    page = HtmlPage(text)
    inside = [link[1:] for link in page.links if link.startswith("#")]
    assert {link for link in page.links if not link.startswith("#")} == {"data:,"}
    assert "@import" not in text
    assert not re.findall(r"url\((?!#)", text)
    assert "<script" not in text
    assert len(page.anchors) == len(set(page.anchors))
    assert set(inside) <= set(page.anchors)
    assert len(inside) > 10


def test_text_of_a_table_cannot_become_markup() -> None:
    table = Table("errors", ["<b>", "n"], [["<script>x</script>", 1]], "a & b")
    page = Page("t", [], [table], [Section("s", "S", ["<i>"], ["<b>"])])
    text = page.render()
    assert "<script" not in text
    assert "&lt;script&gt;" in text
    assert "a &amp; b" in text


LOOK = """<!DOCTYPE html><title>look</title><body style="margin:0">
<iframe id="page" src="{page}" width="{width}" height="2000" style="border:0"></iframe>
<pre id="said"></pre><script>
document.getElementById("page").onload = function () {{
  const inside = this.contentDocument, seen = [];
  const names = test => [...inside.querySelectorAll("figure")].filter(test).map(f => f.id);
  const beyond = element => !element.closest(".scroll") && !element.closest("nav");
  for (const element of inside.querySelectorAll("body *")) {{
    const box = element.getBoundingClientRect();
    if (beyond(element) && !element.closest("svg") && box.right > {width} + 1) {{
      seen.push(element.tagName + " " + element.textContent.slice(0, 40));
    }}
  }}
  let smallest = 99;
  for (const text of inside.querySelectorAll("figure svg text")) {{
    const size = parseFloat(inside.defaultView.getComputedStyle(text).fontSize);
    const scale = text.getScreenCTM() ? text.getScreenCTM().a : 1;
    const turned = text.getScreenCTM() ? Math.hypot(scale, text.getScreenCTM().b) : 1;
    if (text.textContent.trim()) smallest = Math.min(smallest, size * turned);
  }}
  document.getElementById("said").textContent = JSON.stringify({{
    width: inside.documentElement.scrollWidth, beyond: seen, smallest: smallest,
    height: inside.documentElement.scrollHeight, figures: inside.querySelectorAll("figure").length,
    scrolled: names(figure => figure.querySelector("div.scroll")?.scrollWidth
      > figure.querySelector("div.scroll")?.clientWidth),
    hinted: names(figure => figure.querySelector(".hint")?.getClientRects().length),
  }});
}};
</script></body>"""


def look(page: Path, width: int, folder: Path) -> dict:
    """What a browser measures of a page, in a window of this width."""
    assert page.is_file()
    wrapper = folder / "look.html"
    wrapper.write_text(LOOK.format(page=page.as_uri(), width=width))
    slow = ("--allow-file-access-from-files", "--virtual-time-budget=20000", "--dump-dom")
    found = browse(str(wrapper), folder, *slow)
    said = re.search(r'<pre id="said">(.*?)</pre>', found, re.S)
    assert said, found[:500]
    return json.loads(said[1].replace("&gt;", ">").replace("&lt;", "<").replace("&amp;", "&"))


@pytest.mark.parametrize("width", WIDTHS.values(), ids=WIDTHS)
def test_the_page_fits_and_reads_well(own: Path, width: int, tmp_path: Path) -> None:
    seen = look(own, width, tmp_path)
    assert seen["beyond"] == []
    assert seen["width"] <= width
    assert seen["figures"] > 5
    assert seen["smallest"] >= 7.5, "letters too small to read"
    assert seen["hinted"] == seen["scrolled"]
    assert ("picture-datapath" in seen["hinted"]) == (width < 1000)


def test_it_prints(own: Path, tmp_path: Path) -> None:
    paper = tmp_path / "report.pdf"
    browse(own.as_uri(), tmp_path, f"--print-to-pdf={paper}", "--no-pdf-header-footer")
    pages = len(re.findall(rb"/Type\s*/Page\b", paper.read_bytes()))
    assert 3 <= pages <= 60


SVG = "{http://www.w3.org/2000/svg}"

PICTURES = (network, datapath, load_profile)


def parse(text: str) -> ElementTree.Element:
    root = ElementTree.fromstring(text)
    assert root.tag == f"{SVG}svg"
    return root


def words(element: ElementTree.Element, tag: str = "text") -> list[str]:
    return [found.text or "" for found in element.iter(SVG + tag)]


@pytest.mark.parametrize("draw", PICTURES)
def test_a_picture_is_one_accessible_svg_the_same_on_every_run(draw) -> None:
    text = draw(load_scene("digit-instrument"))
    root = parse(text)
    assert root.get("role") == "img"
    assert root[0].tag == f"{SVG}title"
    assert "digit" in (root[0].text or "")
    assert text == draw(load_scene("digit-instrument"))
    assert "<script" not in text


@pytest.mark.parametrize("name", ["digit", "digit-single", "swing-window-cascade"])
def test_the_network_diagram_shows_every_node_and_name(name: str) -> None:
    scene = load_scene(name)
    root = parse(network(scene))
    shown = words(root)
    assert set(scene.sensors) | set(scene.outputs) <= set(shown)
    hidden = [mlp.shape[1] for mlp in scene.mlps()]
    assert [n for n in shown if n.endswith("hidden nodes")] == [f"{n} hidden nodes" for n in hidden]
    circles = [
        len(list(group.iter(f"{SVG}use")))
        for group in root.iter(f"{SVG}g")
        if (group.get("id") or "").startswith("network-hidden")
    ]
    assert circles == hidden
    looks = [(one.text, one.get("style", "")) for one in root.iter(f"{SVG}text")]
    fed_back = [text for text, look in looks if f"fill: {ACCENT}" in look]
    cascade = len(hidden) if scene.arrangement == "cascade" else 0
    assert fed_back == [name for n in range(cascade) for name in scene.outputs[:n]]


# One of each design, and what stands around the networks.
@pytest.mark.parametrize(
    "name",
    [
        *("digit", "thesis", "digit-parallel", "classes/wine-fast", "comparison/digit-tables"),
        *("comparison/digit-lanes4", "digit-learning", "swing-window-cascade", "axis-multiple"),
    ],
)
def test_the_datapath_names_every_block_of_the_design(tmp_path: Path, name: str) -> None:
    scene = scene_of(CASES[name], tmp_path, name) if name in CASES else load_scene(name)
    root = parse(datapath(scene))
    tips = [set(tip.split(", ")) for tip in words(root, "title")[1:]]
    entities = {block.entity for block in walk(scene.twin())}
    assert set().union(*tips) == entities
    shown = " ".join(words(root))
    for block in walk(scene.twin()):
        assert block.block in shown


@pytest.mark.parametrize("name", ["digit", "digit-hybrid", "digit-parallel", "swing-window"])
def test_a_recorded_frame_comes_and_leaves_as_the_twin_says(name: str) -> None:
    scene = load_scene(name)
    design, recording = scene.twin(), scene.vectors().recordings[0][: scene.twin().past + 1]
    (table,) = frame_table(scene)
    clocks, ports, names, codes, values = zip(*table.rows, strict=True)
    assert names == (*scene.sensors, *scene.outputs)
    outputs = np.atleast_2d(design.process(recording))[-1]
    assert list(codes) == [*recording[-1].tolist(), *outputs.tolist()]
    assert list(values) == SIGNAL.to_real(codes).tolist()
    assert set(ports) <= {port.name for port in design.ports}
    assert clocks[0] == 0
    assert clocks[-1] == clocks_per_frame(design) - 1
    after = clocks[-1] - clocks[len(scene.sensors) - 1]
    assert after == design.clocks_after_samples


@pytest.mark.parametrize("name", ["digit-board", "digit-instrument"])
def test_a_frame_that_waits_for_sensors_has_no_table(name: str) -> None:
    assert frame_table(load_scene(name)) == []


def test_only_a_profile_that_is_built_is_drawn() -> None:
    for name, built in (("digit", False), ("digit-instrument", True)):
        drawn = [picture.name for picture in pictures(load_scene(name))]
        assert ("load_profile" in drawn) == built, name


def test_the_load_is_that_of_the_twins_and_of_the_recorded_vectors() -> None:
    scene = load_scene("digit-instrument")
    outputs = scene.twin().process(scene.vectors().codes)
    expected = scene.twin().readout.profile(outputs)[1]
    for frame, top, left, right in ((0, 0.9, 6.35, 57.15), (133, 0.6261, 57.15, 82.55)):
        (at, heights), (fine, curve) = drawn(scene, frame)
        assert heights.tolist() == SIGNAL.to_real(expected[frame]).tolist()
        assert set(at) <= set(fine)
        # It falls to d / e at both ends of the load, and load A is 50.8 mm wide.
        assert curve.max() == pytest.approx(top, abs=0.01)
        assert np.interp([left, right], fine, curve) == pytest.approx(top / np.e, abs=0.02)
    parse(load_profile(scene))


def test_designs_are_those_of_four_outputs_within_a_scan(monkeypatch) -> None:
    """One of two outputs, one without cells, one that waits for a scan, and one of the swing."""
    names = ("digit", "digit-parallel", "digit-learning", "digit-instrument", "swing-single")
    shipped = [load_scene(name) for name in names if name in scene_names()]
    monkeypatch.setattr(run_time, "scenes", lambda: shipped)
    (found,) = run_time.measured()
    top = load_scene("digit").twin()
    assert (found.name, found.clocks) == ("digit", top.clocks_after_samples)


@pytest.mark.parametrize("name", ["area.svg", "designs", "error-against-run-time/networks.svg"])
def test_names_in_the_shipped_pictures_cover_no_other_name(name: str) -> None:
    drawn = design_picture() if name == "designs" else (ROOT / "docs" / name).read_text("utf-8")
    boxes = []
    for word in parse(drawn).iter(f"{SVG}text"):
        look = dict(part.split(": ") for part in word.get("style", "").split("; "))
        if look.get("fill") in (ACCENT, "#999999"):
            font = FontProperties(size=SIZE)
            wide, *_ = TextToPath().get_text_width_height_descent(word.text or "", font, False)
            before = {"start": 0, "end": wide, "middle": wide / 2}[look["text-anchor"]]
            left = float(word.get("x", 0)) - before
            boxes.append((left, float(word.get("y", 0)), left + wide))
    assert len(boxes) > 10
    for (left, y, right), (other_left, other_y, other_right) in combinations(boxes, 2):
        apart = right <= other_left or other_right <= left
        assert apart or abs(y - other_y) >= SIZE
