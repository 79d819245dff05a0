"""Tests what reports say: how sure figures are, where errors occur, and the table of all pages."""

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pages import ROUNDING, shows

from golden.numbers.precision import SIGNAL
from golden.visualisation.load_profile import WIDTH_MM
from tactus.cli import demo
from tactus.core.table import read_table
from tactus.errors import (
    HELD_OUT,
    UNKNOWN,
    disturbed_errors,
    held_out_means,
    held_out_rows,
    held_out_text,
    noises_of,
    scene_errors,
)
from tactus.network_files.network_file import provenance_path, save_network, write_network
from tactus.report.activations import activation_error
from tactus.report.draw.outcome import disturbance_plots, predicted_plots
from tactus.report.measure.networks import scenes as every_scene
from tactus.report.measure.outcome import (
    NONE,
    SURE,
    Outcome,
    confidence,
    noise_and_drift,
    outcome,
    sensors,
)
from tactus.report.page.content import Page
from tactus.report.page.headline import REBUILT, SHOWN, headline
from tactus.report.page.summary import errors, in_units
from tactus.scene import DEFAULT_SCENES, Scene, load_scene, scene_path, thesis_table
from tactus.scene.disturbance import Disturbance
from tactus.scene.scale import Scale, on_readings
from tactus.synth.budget import read_budget
from tactus.train.split import split_of, split_story
from tactus.verify.benches.tools import SIMULATORS
from tactus.verify.every_frame.verdict import DIFFERS, PROVED, SAID
from tactus.verify.every_frame.verdict import UNKNOWN as UNSETTLED
from tb.common.cases import random_mlp


@pytest.fixture(scope="module")
def digit() -> Outcome:
    """The outcome of scene digit, as if every fourth row were held out."""
    return replace(outcome(load_scene("digit")), held_out=np.arange(0, 143, 4))


def test_neighbours_along_the_beam_are_alike_and_those_of_a_shuffled_file_are_not(
    digit: Outcome,
) -> None:
    assert digit.alike
    assert digit.stretches.max() == 19
    assert (np.diff(digit.stretches) >= 0).all()
    order = np.random.default_rng(1).permutation(len(digit.errors))
    single = replace(digit, readings=digit.readings[order], errors=digit.errors[order])
    assert not single.alike
    assert single.stretches.tolist() == list(range(143))


def test_an_interval_holds_the_mean_as_often_as_it_says(digit: Outcome) -> None:
    """Of 300 samples of 60 about 95 % do, apart from chance and the bias of a small bootstrap."""
    rng = np.random.default_rng(3)
    drawn = np.arange(60)
    held = 0
    for _ in range(300):
        low, high = digit.interval(np.abs(rng.standard_normal(60)), drawn)
        held += low < np.sqrt(2 / np.pi) < high
    assert SURE - 6 < 100 * held / 300 < SURE + 4


@pytest.mark.parametrize(("split", "drawn"), [("groups", 3), ("blocks", 4)])
def test_what_was_held_out_as_a_whole_is_drawn_as_a_whole(
    digit: Outcome, split: str, drawn: int
) -> None:
    """The held-out rows are those of three loads, or four stretches of rows."""
    targets = digit.targets[:, 0]
    held = np.flatnonzero(np.isin(targets, np.unique(targets)[:3]))
    if split == "blocks":
        held = np.array([3, 4, 5, 9, 10, 20, 22])
    training = replace(digit.scene.training, split=split, split_by=("load",))
    found = replace(digit, held_out=held, scene=replace(digit.scene, training=training))
    members = found.held_together
    assert len(np.unique(members)) == drawn
    if split == "groups":
        assert len(np.unique(np.column_stack([members, targets[held]]), axis=0)) == drawn
    table = confidence(found)
    assert f"{drawn} in all" in table.note
    row = next(row for row in table.rows if row[1] == "mean, held out")
    assert tuple(row[4:]) == found.interval(digit.errors[held, 0], members)


def test_readings_outside_the_range_are_counted_per_sensor(tmp_path: Path) -> None:
    scene = load_scene("digit-load")
    header, *lines = scene.data_path.read_text().splitlines()
    for n, reading in enumerate([1.5, -1.2, 1.2, 1.5]):
        lines[n] = f"{reading}," + lines[n].partition(",")[2]
    path = tmp_path / "readings.csv"
    path.write_text("\n".join([header, *lines]) + "\n")
    first, *others = sensors(outcome(replace(scene, data_paths=(path,)))).rows
    assert first[:6] == ["sensor1", -1.2, 1.5, -1.0, 8191 / 8192, 4]
    assert first[6] == pytest.approx(100 * 4 / 143)
    assert first[7] == 3
    assert [row[5] for row in others] == [0, 0, 0]


def test_rows_that_the_scene_leaves_out_keep_their_numbers() -> None:
    scene = load_scene("digit-parallel")
    found = outcome(scene)
    assert len(found.numbers) < found.numbers.max()
    lines = scene.data_path.read_text().splitlines()
    header = lines[0].split(",")
    at = [header.index(name) for name in scene.sensors]
    for number, readings in zip(found.numbers, found.readings, strict=True):
        cells = lines[number].split(",")
        assert [float(cells[c]) for c in at] == readings.tolist()


def test_the_plots_hold_what_the_tables_hold(digit: Outcome) -> None:
    (first, *_) = predicted_plots(digit)
    groups = {label: list(map(tuple, pairs.T.tolist())) for label, pairs in first.groups.items()}
    assert {label: len(points) for label, points in groups.items()} == {
        "trained or chose": 107,
        "held out": 36,
    }
    pairs = zip(digit.targets[:, 0].tolist(), digit.results[:, 0].tolist(), strict=True)
    assert sorted(point for points in groups.values() for point in points) == sorted(pairs)
    held = digit.targets[digit.held_out, 0]
    assert sorted(x for x, _ in groups["held out"]) == sorted(held)


def test_the_plots_of_disturbances_hold_what_their_table_holds() -> None:
    table = noise_and_drift(load_scene("digit"), 1)
    noise, gain, offset = disturbance_plots(table)
    rows = {(row[0], row[1]): row for row in table.rows}
    assert noise.groups.keys() == gain.groups.keys() == offset.groups.keys()
    for plot, kind in ((noise, "noise"), (gain, "gain drift"), (offset, "offset drift")):
        (_, recorded), *points = map(tuple, plot.groups["load"].T.tolist())
        assert recorded == rows["as recorded", 0.0][2]
        assert points == [(size, row[2]) for (one, size), row in rows.items() if one == kind]


def test_the_table_of_all_pages_holds_the_figures_of_scenes_and_thesis() -> None:
    scenes = [load_scene(name) for name in (REBUILT, SHOWN)]
    rows = {row[0]: row[1:] for row in headline().rows}
    printed, board = thesis_table("digit.cascade_b"), thesis_table("board")
    errors = [max(e.largest_mean for e in scene_errors(s)["bit-true"]) for s in scenes]
    clocks = [scene.twin().clocks_after_samples for scene in scenes]
    cells = [read_budget(scene.path)["xc2v"][scene.twin().entity] for scene in scenes]
    for name, figures in {
        "mean error on held-out rows": [None, *(max(held_out_means(s) or []) for s in scenes)],
        "mean error at the worst position": [max(printed["simulation"]), *errors],
        "the same, with real sensors": [max(printed["real_time"]), None, None],
        "clocks after the last sample": [None, *clocks],
        "the same in µs at 64 MHz": [None, *(n / board["clock_mhz"] for n in clocks)],
        "LUTs": [28672 * printed["luts_percent"] / 100, *(one["LUT"] for one in cells)],
        "multipliers": [96 * printed["mult18x18_percent"] / 100, *(c["multiplier"] for c in cells)],
        "block RAMs": [None, *(one["block RAM"] for one in cells)],
    }.items():
        for cell, figure in zip(rows[name], figures, strict=True):
            text = str(cell).removeprefix("about ").removesuffix(" %")
            assert text == "-" if figure is None else shows(text, figure, ROUNDING), name


@pytest.mark.parametrize(
    ("failed", "verdict", "code"),
    [(0, PROVED, 0), (0, UNSETTLED, 0), (0, DIFFERS, 1), (1, PROVED, 1)],
)
def test_the_demo_ends_with_the_table_of_all_pages(
    monkeypatch, capsys, failed: int, verdict: int, code: int
) -> None:
    """It says of no network that it is proved if it is not."""
    results = {
        "benches": 9,
        "kept": 0,
        "left_out": [],
        "failed": failed,
        "compared": 987654,
        "facts": {simulator: {"frames": 10, "seconds": 2.0} for simulator in SIMULATORS},
        "blocks": {"abs_unit": {simulator: [1, 70] for simulator in SIMULATORS}},
    }
    monkeypatch.setattr(demo, "simulate", lambda *_: results)
    monkeypatch.setattr(demo, "proof_line", lambda scene, ask: f"{SAID[verdict]}{scene.name}")
    monkeypatch.setattr(demo, "build_report", lambda scene: Page(f"of {scene.name}", [], [], []))
    assert demo.demonstrate([load_scene(name) for name in DEFAULT_SCENES]) == code
    told = capsys.readouterr().out
    assert f"9 benches (0 unchanged since they passed and not run again), {failed} failed" in told
    if code == 0:
        assert "of thesis" in told
        assert "icarus 5, numpy twin" in told
        (line,) = [line for line in told.splitlines() if line.startswith("proved for  ")]
        assert line.count("all 2^56 frames") == 2 * (verdict == PROVED)
        assert line.count("not proved") == 2 * (verdict == UNSETTLED)
        assert told.splitlines()[-1] == headline().lines()[-1]


def test_the_first_tables_say_what_their_errors_are_of() -> None:
    note = errors(outcome(load_scene("digit"))).note
    assert "100 % is 0.9 for position, 0.9 for width, the recorded value for load, shape." in note
    (lengths,) = in_units(load_scene("swing-single"))
    assert lengths.columns == ["output", "in", "mean", "worst"], "there are no positions"


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """A copy of digit-single whose network was trained here, on a random half of the rows."""
    folder = scene_path("digit-single").parent
    for path in folder.glob("digit-single*"):
        shutil.copy(path, tmp_path)
    data = folder / "../data/appendix2.csv"
    shutil.copy(data, tmp_path)
    text = (tmp_path / "digit-single.toml").read_text().replace("../data/", "")
    path = tmp_path / "digit-single.toml"
    path.write_text(f"{text.partition('[training]')[0]}[training]\nseed = 1\n")
    loaded = load_scene(str(path))
    story = split_story(loaded) | {"network": loaded.describe()}
    provenance(path).write_text("".join(f"{key} = {value!r}\n" for key, value in story.items()))
    return path


def provenance(scene: Path) -> Path:
    return provenance_path(load_scene(str(scene)).members[0].weights_path)


@pytest.mark.parametrize("scene", every_scene(), ids=lambda s: s.name)
def test_the_held_out_rows_of_every_shipped_scene_are_known(scene: Scene) -> None:
    rows = held_out_rows(scene)
    assert (rows is None) == scene.training.refit
    if rows is not None:
        assert rows.tolist() == split_of(scene).test.tolist()


def other_network(scene: Path) -> None:
    """Replace the trained network, and keep its provenance."""
    member = load_scene(str(scene)).members[0]
    story = provenance(scene).read_text()
    save_network(member.weights_path, random_mlp((4, 5, 4), 0.1, 1), {})
    provenance(scene).write_text(story)
    scene.write_text(scene.read_text().replace("hidden = 16", "hidden = 5"))


def other_data(scene: Path) -> None:
    (scene.parent / "appendix2.csv").rename(scene.parent / "mine.csv")
    scene.write_text(scene.read_text().replace("appendix2.csv", "mine.csv"))


def added(name: str, more: str) -> Callable[[Path], object]:
    """Add a line to a file of the scene."""
    return lambda s: (path := s.parent / name).write_text(path.read_text() + more)


CHANGES = {
    "trained elsewhere": lambda scene: provenance(scene).unlink(),
    "other data": other_data,
    "other seed": lambda s: s.write_text(s.read_text().replace("seed = 1", "seed = 2")),
    "other split": added("digit-single.toml", 'split = "blocks"\n'),
    "other rows": added("appendix2.csv", "0.1,0.2,0.3,0.4,0.5,0.5,0.5,0.5\n"),
    "other network": other_network,
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_what_was_not_trained_here_holds_nothing_out(
    scene: Path, change: Callable[[Path], object]
) -> None:
    assert held_out_rows(load_scene(str(scene))) is not None
    change(scene)
    changed = load_scene(str(scene))
    assert held_out_rows(changed) is None
    assert HELD_OUT not in scene_errors(changed)
    assert {row[1] for row in errors(outcome(changed)).rows} == {UNKNOWN}
    assert held_out_text(changed) == UNKNOWN


@pytest.mark.parametrize(
    "disturbance",
    [Disturbance(noise=0.008), Disturbance(gain=0.01), Disturbance(offset=0.01)],
    ids=["noise", "gain", "offset"],
)
def test_the_errors_are_the_mean_of_whole_recordings(disturbance: Disturbance) -> None:
    """They agree within five standard deviations of the mean over many recordings."""
    scene = load_scene("digit")
    vectors, rng = scene.vectors(), np.random.default_rng(5)
    means = []
    for _ in range(200):
        codes, _ = SIGNAL.quantise(disturbance.of(vectors.inputs, rng))
        results = SIGNAL.to_real(scene.twin().process(codes))
        means.append(vectors.percent_errors(results).mean(axis=0))
    deviation = np.std(means, axis=0) / np.sqrt(len(means))
    miss = np.abs(np.mean(means, axis=0) - disturbed_errors(scene, disturbance))
    assert (miss < 5 * deviation).all()
    assert (deviation < 0.1 * np.mean(means, axis=0)).all()


def test_noise_and_drift_are_in_the_unit_of_the_readings(tmp_path: Path) -> None:
    """The converter gives -1024 to 1024, so sizes are a thousand times larger, to two digits."""
    scene = load_scene("digit-load")
    header, *lines = scene.data_path.read_text().splitlines()
    cells = [line.split(",") for line in lines]
    raw = [[*(f"{1024 * float(cell)!r}" for cell in row[:4]), *row[4:]] for row in cells]
    path = tmp_path / "raw.csv"
    path.write_text("\n".join([header, *map(",".join, raw)]) + "\n")
    (member,) = scene.members
    weights = tmp_path / "raw.npz"
    write_network(weights, on_readings(member.load(), [Scale(0.0, 1024.0)] * 4, [Scale()]))
    unstated = replace(scene.training, disturbance=Disturbance())
    scaled = replace(
        scene,
        training=unstated,
        data_paths=(path,),
        members=(replace(member, weights_path=weights),),
        scale=dict.fromkeys(scene.sensors, Scale(0.0, 1024.0)),
    )
    assert noises_of(scaled) == [2.0]
    for found, plain in zip(
        noise_and_drift(scaled, 1).rows, noise_and_drift(scene, 1).rows, strict=True
    ):
        (kind, size, error), (kind_there, size_there, error_there) = found[:3], plain[:3]
        assert kind == kind_there
        same = kind in (NONE, "gain drift")
        assert size == (size_there if same else pytest.approx(1000 * size_there))
        # 1000 instead of 1024 makes a difference of 2.3 %.
        assert error == pytest.approx(error_there, rel=1e-9 if same else 0.03)


def test_the_codes_of_table_3_1() -> None:
    data = Path(__file__).parents[1] / "scenes" / "data" / "appendix2.csv"
    load, width = (np.unique(column) for column in read_table(data, ("load", "width")).T)
    assert np.allclose(width / 0.9 * WIDTH_MM, [12.7, 25.4, 38.1, 50.8])
    assert np.allclose(load / 0.9 * 23, [6, 8, 9, 11, 12, 16, 19, 23], atol=0.01)


@pytest.mark.parametrize("points", [7, 600, 100_001])
def test_activation_error_of_known_integrals(points: int) -> None:
    q = np.linspace(-3, 3, points)
    assert activation_error(np.full(points, -0.01), q) == pytest.approx(1.0)
    # The integral of |q| over [-3, 3] is 9. Trapezoids give it exactly if 0 is on the grid.
    assert activation_error(q, q) == pytest.approx(150, rel=9 / points**2)
