"""The pictures of the report are well-formed, reproducible, and show the right values."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextToPath

from golden.common.block import walk
from golden.input_error import InputError
from golden.numbers.precision import SIGNAL
from tactus.core.fingerprint import ROOT
from tactus.errors import held_out_means
from tactus.report.draw import run_time
from tactus.report.draw.datapath import datapath
from tactus.report.draw.load import drawn, has_load, load_profile
from tactus.report.draw.named import SIZE
from tactus.report.draw.network import network
from tactus.report.draw.pictures import Skipped, pictures
from tactus.report.draw.svg import ACCENT
from tactus.report.draw.waveforms import Row, waveforms
from tactus.report.measure.simulated_frame import simulate_frame
from tactus.report.page.made import design_picture
from tactus.scene import Scene, load_scene, scene_names
from tactus.scene.scale import Scale
from tactus.verify.benches.collected import CASES
from tactus.verify.benches.written import scene_of

SVG = "{http://www.w3.org/2000/svg}"
FRAME = 40


def flag(*values: int | None) -> Row:
    return Row("top", "valid", values)


def data(*values: int | None) -> Row:
    return Row("top", "data", values, SIGNAL, "valid")


def drawn_waveforms(scene: Scene) -> str:
    return waveforms([flag(0, 1, 1), data(0, 1, -8192)], f"Two elements of scene {scene.name}")


PICTURES = (network, datapath, drawn_waveforms, load_profile)


def parse(text: str) -> ElementTree.Element:
    root = ElementTree.fromstring(text)
    assert root.tag == f"{SVG}svg"
    return root


def words(element: ElementTree.Element, tag: str = "text") -> list[str]:
    return [found.text or "" for found in element.iter(SVG + tag)]


@pytest.fixture(scope="module")
def build(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("pictures")


@pytest.fixture(scope="module")
def recorded(build: Path) -> list[Row]:
    """One frame of scene digit through its exported Verilog."""
    return simulate_frame(load_scene("digit-hybrid"), FRAME, build)


def port(ports: list[Row], owner: str, name: str) -> Row:
    (found,) = [p for p in ports if p.owner.startswith(owner) and p.name == name]
    return found


def counting(ports: list[Row], owner: str, name: str) -> list[int | None]:
    """The values of a port in the clocks in which its data count."""
    found = port(ports, owner, name)
    flags = port(ports, owner, found.valid).values
    return [value for value, valid in zip(found.values, flags, strict=True) if valid]


@pytest.mark.parametrize("draw", PICTURES)
def test_a_picture_is_one_accessible_svg_the_same_on_every_run(draw) -> None:
    text = draw(load_scene("digit"))
    root = parse(text)
    assert root.get("role") == "img"
    assert root[0].tag == f"{SVG}title"
    assert "digit" in (root[0].text or "")
    assert text == draw(load_scene("digit"))
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


def test_the_recording_holds_what_the_twin_computes(recorded: list[Row]) -> None:
    scene = load_scene("digit-hybrid")
    codes = scene.vectors().codes[FRAME]
    outputs = scene.twin().process(codes)
    assert counting(recorded, "cascade, frame in", "in_data")[: len(codes)] == codes.tolist()
    assert counting(recorded, "cascade, frame out", "out_data") == outputs.tolist()
    for n, output in enumerate(outputs):
        seen = [*codes, *outputs[:n]]
        assert counting(recorded, f"hybrid_{n}", "in_data") == seen
        assert counting(recorded, f"hybrid_{n}", "out_data") == [output]


def test_the_waveforms_show_the_recorded_values(recorded: list[Row]) -> None:
    root = parse(waveforms(recorded, "One frame of scene digit-hybrid"))
    shown = words(root)
    assert {port.name for port in recorded} | {port.owner for port in recorded} <= set(shown)
    codes = [
        code for port in recorded if port.fmt for code in counting(recorded, port.owner, port.name)
    ]
    values = [f"{value:.4f}" for value in SIGNAL.to_real(codes)]
    assert [word for word in shown if "." in word and word[-4:].isdecimal()] == values


@pytest.mark.parametrize("name", ["digit-board", "digit-instrument"])
def test_a_frame_that_waits_for_sensors_is_not_drawn(name: str) -> None:
    titles = [one.title for one in pictures(load_scene(name)) if isinstance(one, Skipped)]
    assert "One recorded frame, clock by clock" in titles


def test_outputs_at_once_are_recorded_too(tmp_path: Path) -> None:
    scene = scene_of(CASES["parallel"], tmp_path, "parallel")
    ports = simulate_frame(scene, 1, tmp_path)
    outputs = scene.twin().process(scene.vectors().codes[1]).tolist()
    owner = f"{scene.twin().entity}, frame out"
    (valid,) = np.flatnonzero(port(ports, owner, "out_valid").values)
    assert [
        port(ports, owner, f"out_data_{n}").values[valid] for n in range(len(outputs))
    ] == outputs


def test_a_frame_that_was_not_recorded_is_refused(build: Path) -> None:
    with pytest.raises(InputError, match=r"digit.toml: frame: got 143, expected 0 to 142"):
        simulate_frame(load_scene("digit"), 143, build)


@pytest.mark.parametrize(
    "change", [{"length_mm": {"position": 127.0}}, {"scale": {"load": Scale(100.0, 100.0)}}]
)
def test_outputs_of_those_names_alone_are_no_load(change: dict) -> None:
    """Examples are a load in grams, or a width of unknown length."""
    assert has_load(load_scene("digit"))
    assert not has_load(replace(load_scene("digit"), **change))


def test_the_load_is_that_of_the_twins_and_of_the_recorded_vectors() -> None:
    scene = load_scene("digit-instrument")
    codes = scene.vectors().codes
    profile = scene.twin().readout.profile
    outputs = scene.twin().process(codes)
    expected = profile(outputs)[1]
    for frame in (0, 100, 142):
        known = drawn(scene, frame)
        at, heights = known.points
        assert heights.tolist() == SIGNAL.to_real(expected[frame]).tolist()
        frames = outputs[frame, list(scene.visualisation.results)]
        real = scene.visualisation.load_profile.real(frames)
        assert np.allclose(known.exact(at), real, rtol=0, atol=1e-12)
    at, height = drawn(scene, 0).true
    # Load A is 50.8 mm wide, and its first placement is 31.75 mm from the tip.
    assert at.round(2).tolist() == [6.35, 6.35, 57.15, 57.15]
    assert height.tolist() == [0.0, 0.9, 0.9, 0.0]
    assert drawn(scene, 142).true[1].tolist() == [0.0, 0.6261, 0.0]
    parse(load_profile(scene))


def test_designs_are_those_of_four_outputs_within_a_scan(monkeypatch) -> None:
    """One of two outputs, one without cells, one that waits for a scan, and one of the swing."""
    names = ("digit", "digit-parallel", "digit-learning", "digit-instrument", "swing-single")
    shipped = [load_scene(name) for name in names if name in scene_names()]
    monkeypatch.setattr(run_time, "scenes", lambda: shipped)
    (found,) = run_time.measured()
    top = load_scene("digit").twin()
    assert (found.name, found.clocks) == ("digit", top.output_clocks[-1])
    assert found.held_out == max(held_out_means(load_scene("digit")) or [])


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
