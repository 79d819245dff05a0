"""Tests the errors of a scene, the measures of errors, and noise and drift of sensors."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from golden.numbers.precision import SIGNAL
from golden.numbers.units import FULL_SCALE, LOAD_G, WIDTH_MM
from tactus.cli.demo import error_table
from tactus.core.table import read_table
from tactus.errors import (
    HELD_OUT,
    UNKNOWN,
    disturbed_errors,
    held_out_rows,
    held_out_text,
    noises_of,
    scene_errors,
)
from tactus.network_files.network_file import provenance_path, save_network, write_network
from tactus.report.measure.disturbance import NONE, noise_and_drift
from tactus.report.measure.networks import scenes
from tactus.scene import Scene, load_scene, scene_path
from tactus.scene.disturbance import Disturbance
from tactus.scene.metrics import activation_error, displacement_errors
from tactus.scene.scale import Scale, on_readings
from tactus.train.split import split_of, split_story
from tb.common.cases import random_mlp


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
    write_provenance(path)
    return path


def write_provenance(scene: Path, *leave_out: str) -> None:
    """Write the provenance that training would write for a scene, without some keys."""
    loaded = load_scene(str(scene))
    story = split_story(loaded) | {"network": loaded.describe()}
    lines = [f"{key} = {value!r}\n" for key, value in story.items() if key not in leave_out]
    provenance(scene).write_text("".join(lines))


def provenance(scene: Path) -> Path:
    return provenance_path(load_scene(str(scene)).members[0].weights_path)


@pytest.mark.parametrize("scene", scenes(), ids=lambda s: s.name)
def test_the_held_out_rows_of_every_shipped_scene_are_known(scene: Scene) -> None:
    rows = held_out_rows(scene)
    assert (rows is None) == scene.training.refit
    if rows is not None:
        assert rows.tolist() == split_of(scene).test.tolist()


def elsewhere(scene: Path) -> None:
    provenance(scene).unlink()


def other_data(scene: Path) -> None:
    (scene.parent / "appendix2.csv").rename(scene.parent / "mine.csv")
    scene.write_text(scene.read_text().replace("appendix2.csv", "mine.csv"))


def other_seed(scene: Path) -> None:
    scene.write_text(scene.read_text().replace("seed = 1", "seed = 2"))


def other_split(scene: Path) -> None:
    scene.write_text(scene.read_text() + 'split = "blocks"\n')


def other_rows(scene: Path) -> None:
    """Add a row to the file."""
    data = scene.parent / "appendix2.csv"
    data.write_text(data.read_text() + data.read_text().splitlines()[-1] + "\n")


def other_network(scene: Path) -> None:
    """Replace the trained network, and keep its provenance."""
    member = load_scene(str(scene)).members[0]
    story = provenance(scene).read_text()
    save_network(member.weights_path, random_mlp((4, 5, 4), 0.1, 1), {})
    provenance(scene).write_text(story)
    scene.write_text(scene.read_text().replace("hidden = 16", "hidden = 5"))


@pytest.mark.parametrize(
    "change", [elsewhere, other_data, other_seed, other_split, other_rows, other_network]
)
def test_what_was_not_trained_here_holds_nothing_out(scene: Path, change) -> None:
    assert held_out_rows(load_scene(str(scene))) is not None
    change(scene)
    changed = load_scene(str(scene))
    assert held_out_rows(changed) is None
    assert HELD_OUT not in scene_errors(changed)
    assert "held out" not in "\n".join(error_table(changed))
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
    assert np.allclose(width / FULL_SCALE * WIDTH_MM, [12.7, 25.4, 38.1, 50.8])
    assert np.allclose(load / FULL_SCALE * LOAD_G, [6, 8, 9, 11, 12, 16, 19, 23], atol=0.01)


def test_displacement_errors_of_a_sine() -> None:
    """The distance from end to end of a sine is twice its amplitude."""
    t = (np.arange(100_000) + 0.5) / 100_000
    actual = np.stack([np.sin(2 * np.pi * t), 300 * np.cos(4 * np.pi * t)], axis=1)
    found = displacement_errors(actual + np.array([0.01, -6.0]), actual)
    assert [e.mean for e in found] == pytest.approx([0.01, 6.0])
    assert [e.displacement for e in found] == pytest.approx([2, 600], rel=1e-6)
    assert [e.percent for e in found] == pytest.approx([0.5, 1], rel=1e-6)


@pytest.mark.parametrize("points", [7, 600, 100_001])
def test_activation_error_of_known_integrals(points: int) -> None:
    q = np.linspace(-3, 3, points)
    constant = activation_error(np.full(points, -0.01), q)
    assert constant.mean_percent == pytest.approx(1.0)
    assert constant.mean_percent_thesis == pytest.approx(2.0)
    assert constant.largest == pytest.approx(81.92)
    # The integral of |q| over [-3, 3] is 9. Trapezoids give it exactly if 0 is on the grid.
    assert activation_error(q, q).mean_percent == pytest.approx(150, rel=9 / points**2)


READINGS = np.linspace(-1, 1, 4000).reshape(1000, 4)


def test_noise_is_of_every_reading():
    noise = Disturbance(noise=0.002).of(READINGS, np.random.default_rng(1)) - READINGS
    # The standard deviation of 4000 draws is within 5 %, which is more than four of its own
    # deviations.
    assert noise.std() == pytest.approx(0.002, rel=0.05)
    assert abs(np.corrcoef(noise[:-1].ravel(), noise[1:].ravel())[0, 1]) < 0.1


def test_drift_is_one_of_each_sensor():
    changed = Disturbance(gain=0.01, offset=0.02).of(READINGS, np.random.default_rng(1))
    lines = [np.polyfit(READINGS[:, s], changed[:, s], 1) for s in range(4)]
    for s, line in enumerate(lines):
        np.testing.assert_allclose(np.polyval(line, READINGS[:, s]), changed[:, s], atol=1e-12)
    assert len({round(gain, 6) for gain, _ in lines}) == 4
    assert len({round(offset, 6) for _, offset in lines}) == 4
