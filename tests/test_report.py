"""Tests the report of a user's scene: its content, the files beside it, and its look."""

import csv
import json
import re
import shutil
import subprocess
from html.parser import HTMLParser
from pathlib import Path

import pytest
from shared import Shared

from tactus.core.fingerprint import ROOT
from tactus.report.measure.table import Table
from tactus.report.page import build
from tactus.report.page.content import Page, Section, content
from tactus.scene import load_scene
from tactus.scene.reading import scene_path
from tactus.verify.benches.runner import BUILD

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
    wanted |= {"sensors", "sensors_tell", "designs"}
    assert set(own_data["tables"]) == wanted
    predicted = {f"predicted_{c}" for c in range(4)}
    disturbed = {f"disturbed_{kind}" for kind in ("noise", "gain", "offset")}
    drawn = {"network", "datapath", "waveforms", "load_profile"}
    assert set(own_data["pictures"]) == {"along", "designs", *predicted, *disturbed, *drawn}
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


class Links(HTMLParser):
    """Everything that a page loads or links to, and every id."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.loads: list[str] = []
        self.anchors: list[str] = []
        self.ids: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for key, value in attrs:
            if key == "id":
                self.ids.append(value or "")
            elif key in ("href", "xlink:href") and (value or "").startswith("#"):
                self.anchors.append((value or "")[1:])
            elif key in ("src", "href", "xlink:href", "data", "srcset"):
                self.loads.append(value or "")


def test_the_page_needs_nothing_beside_it_and_every_anchor_leads_somewhere(own: Path) -> None:
    text = own.read_text()
    links = Links(text)
    assert [link for link in links.loads if link != "data:,"] == []
    assert "@import" not in text
    assert not re.findall(r"url\((?!#)", text)
    assert "<script" not in text
    assert len(links.ids) == len(set(links.ids))
    assert set(links.anchors) <= set(links.ids)
    assert len(links.anchors) > 10


def test_a_second_report_measures_nothing(shared: Shared, own: Path) -> None:
    told: list[tuple[str, bool]] = []
    with shared.own_store():
        scene = load_scene(str(shared.folder / OWN / f"{OWN}.toml"))
        content(scene, lambda name, _, kept: told.append((name, kept)))
    assert told
    assert [name for name, kept in told if not kept] == []


def test_text_of_a_table_cannot_become_markup() -> None:
    table = Table("errors", ["<b>", "n"], [["<script>x</script>", 1]], "a & b")
    page = Page("t", [], table, table, [Section("s", "S", ["<i>"], ["<b>"])])
    text = page.render()
    assert "<script" not in text
    assert "&lt;script&gt;" in text
    assert "a &amp; b" in text


BROWSER = shutil.which("chromium")
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
    assert BROWSER, "chromium is not installed; on Debian: apt-get install chromium"
    assert page.is_file()
    wrapper = folder / "look.html"
    wrapper.write_text(LOOK.format(page=page.as_uri(), width=width))
    found = browser(
        "--allow-file-access-from-files", "--virtual-time-budget=20000", "--dump-dom", wrapper
    )
    said = re.search(r'<pre id="said">(.*?)</pre>', found, re.S)
    assert said, found[:500]
    return json.loads(said[1].replace("&gt;", ">").replace("&lt;", "<").replace("&amp;", "&"))


def browser(*options: object) -> str:
    command = [BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"]
    # No host name resolves, so that nothing can be loaded from a network.
    command += ["--host-resolver-rules=MAP * ~NOTFOUND", *map(str, options)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    return done.stdout


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
    browser(f"--print-to-pdf={paper}", "--no-pdf-header-footer", own.as_uri())
    pages = len(re.findall(rb"/Type\s*/Page\b", paper.read_bytes()))
    assert 3 <= pages <= 60
