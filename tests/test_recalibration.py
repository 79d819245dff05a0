"""Tests make recalibrate, which finds gain and offset of each sensor from known placements."""

import re
import shutil
import tomllib
from contextlib import suppress
from dataclasses import replace
from functools import cache
from itertools import islice
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from refused import call

from golden.input_error import InputError
from golden.numbers.precision import SIGNAL
from tactus.core.table import write_table
from tactus.network_files.network_file import read_provenance
from tactus.recalibration.fit import fit, left_out, misses
from tactus.recalibration.folder import _scene_text, now_read
from tactus.recalibration.outlook import LEAST_PLACEMENTS, helps, outlook, plan, proposed
from tactus.recalibration.sensitivity import (
    LEAST_FREE,
    Placements,
    Sensitivity,
    grouped,
    noise_of_repeats,
    outputs_and_slopes,
)
from tactus.scene import Scene, Vectors, load_scene
from tactus.scene.disturbance import Disturbance
from tactus.scene.scale import Scale, readings, signals

DRIFT = Disturbance(gain=0.03, offset=0.02)


RAIL = Path(__file__).parent / "data" / "rail" / "rail.toml"


@cache
def digit(noise: float = 0.0) -> tuple[Scene, Sensitivity]:
    scene = load_scene("digit")
    return scene, Sensitivity.of(scene, np.full(len(scene.sensors), noise))


def at(scene: Scene, rows: np.ndarray, inputs: np.ndarray) -> Placements:
    """Rows of the recording as placements, with other readings."""
    vectors = scene.vectors()
    return Placements(inputs[rows], vectors.targets[rows], vectors.scale[rows], np.ones(len(rows)))


def mean_errors(scene: Scene, samples: np.ndarray) -> np.ndarray:
    return scene.vectors().percent_errors(scene.process_real(samples)).mean(axis=0)


@pytest.mark.parametrize("name", ["digit", "digit-multiple"])
def test_slopes_are_finite_differences_of_the_outputs(name: str) -> None:
    scene, step = load_scene(name), 1e-6
    samples = scene.vectors().inputs
    outputs, slopes = outputs_and_slopes(scene, samples)
    assert outputs == pytest.approx(scene.process_real(samples), abs=1e-12)
    for sensor in range(len(scene.sensors)):
        moved = step * np.eye(len(scene.sensors))[sensor]
        higher, lower = (scene.process_real(samples + sign * moved) for sign in (1, -1))
        assert slopes[:, :, sensor] == pytest.approx((higher - lower) / (2 * step), abs=1e-6)


def test_a_drift_is_undone_where_the_outputs_are_the_networks_own() -> None:
    """Only the drift is between readings and outputs, so the fit finds its inverse."""
    scene, recorded = digit()
    vectors = scene.vectors()
    exact = scene.process_real(vectors.inputs)
    drift = [Scale(0.02, 1.03), Scale(-0.03, 0.98), Scale(0.01, 1.0), Scale(0.0, 0.96)]
    drifted = readings(vectors.inputs, drift)
    placements = replace(at(scene, np.arange(0, 143, 5), drifted), targets=exact[::5])
    found = recorded.correction(fit(recorded, placements).theta)
    for one, known in zip(found, drift, strict=True):
        assert one.factor == pytest.approx(1 / known.factor, abs=2e-3)
        assert one.offset == pytest.approx(-known.offset / known.factor, abs=2e-3)


def test_twenty_placements_at_random_bring_the_errors_back() -> None:
    """Errors of several percent come down nearly to those without drift, for ten drifts.

    For some of them, a descent that starts only from no correction ends elsewhere.
    """
    scene, recorded = digit()
    vectors, rng = scene.vectors(), np.random.default_rng(2)
    own = mean_errors(scene, vectors.inputs)
    before, after = [], []
    for _ in range(10):
        drifted = DRIFT.of(vectors.inputs, rng)
        placements = at(scene, rng.permutation(143)[:20], drifted)
        before.append(mean_errors(scene, drifted))
        found = recorded.correction(fit(recorded, placements).theta)
        after.append(mean_errors(scene, readings(drifted, found)))
    assert np.mean(before, axis=0).min() > 10 * own.max()
    assert (np.mean(after, axis=0) < 1.4 * own).all()
    assert np.max(after) < 3 * own.max()


def test_rows_of_one_placement_are_its_repeats() -> None:
    scene, _ = digit()
    rng = np.random.default_rng(3)
    rows = np.array([7, 3, 7, 3, 3, 90])
    vectors = scene.vectors()
    inputs = vectors.inputs[rows] + 0.01 * rng.standard_normal((6, 4))
    read = replace(vectors, inputs=inputs, targets=vectors.targets[rows], scale=vectors.scale[rows])
    found, place = grouped(read, np.array([8.0, 2, 8, 2, 2, 9]))
    assert place.tolist() == [0, 1, 0, 1, 1, 2]
    assert found.times.tolist() == [2, 3, 1]
    assert found.inputs[1] == pytest.approx(inputs[[1, 3, 4]].mean(axis=0))
    assert (found.targets == vectors.targets[[7, 3, 90]]).all()
    assert LEAST_FREE == 4
    assert noise_of_repeats(read, found, place) is None
    assert grouped(read, None)[0].times.tolist() == [1] * 6
    with pytest.raises(InputError, match="'placement': got 2 in row 6 with other outputs than"):
        grouped(read, np.array([8.0, 5, 8, 2, 2, 2]))
    rows = np.repeat(np.arange(40), 6)
    inputs = vectors.inputs[rows] + np.array([0.01, 0.02, 0, 0.04]) * rng.standard_normal((240, 4))
    read = replace(vectors, inputs=inputs, targets=vectors.targets[rows], scale=vectors.scale[rows])
    noise = noise_of_repeats(read, *grouped(read, rows * 1.0))
    assert noise == pytest.approx([0.01, 0.02, 0, 0.04], rel=0.15, abs=1e-12)


def test_a_placement_left_out_takes_no_part() -> None:
    """Its error does not depend on its own labels, except by the difference to them."""
    scene, recorded = digit(0.002)
    drifted = DRIFT.of(scene.vectors().inputs, np.random.default_rng(5))
    there = at(scene, np.arange(4, 143, 20), drifted)
    left = left_out(recorded, there, fit(recorded, there))
    none = np.zeros(8)
    assert left.before == pytest.approx(misses(recorded, there, none))
    assert left.improves
    for number in (0, 4):
        others = fit(recorded, there.without(number))
        expected = misses(recorded, there, others.theta)[number]
        assert left.after[number] == pytest.approx(expected, rel=1e-2, abs=1e-3)
        wrong = there.targets.copy()
        wrong[number] += 0.02
        moved = replace(there, targets=wrong)
        again = left_out(recorded, moved, fit(recorded, moved))
        shift = -100 * 0.02 / there.scale[number]
        assert again.after[number] - left.after[number] == pytest.approx(shift, abs=2e-2)


@pytest.mark.parametrize("name", ["digit-load", "digit-parallel", "swing-single"])
def test_any_scene_gets_a_plan_that_is_enough(name: str) -> None:
    scene = load_scene(name)
    recorded = Sensitivity.of(scene, np.full(len(scene.sensors), 0.001))
    found = plan(recorded)
    assert found
    assert len(found.placements) >= LEAST_PLACEMENTS
    assert found.placements[-1].expected.enough
    assert not any(one.expected.enough for one in found.placements[LEAST_PLACEMENTS - 1 : -1])
    after = [one.expected.after.mean() for one in found.placements]
    assert after == sorted(after, reverse=True)


@cache
def rail() -> Scene:
    return load_scene(str(RAIL))


def touched(touches: np.ndarray, noise: float, drift: float, rng: np.random.Generator) -> Vectors:
    """Readings of touches of the rail, by force and place, with noise and two drifted gains."""
    scene = rail()
    gains = 1 + drift * np.array([0, 1, 0, 1, 0])
    apart = (touches[:, 1:] - np.linspace(30, 270, 5)) / 90
    read = gains * touches[:, :1] / 30 * np.exp(-(apart**2))
    read = read + noise * rng.standard_normal(read.shape)
    targets = signals(touches, scene.scales(scene.outputs))
    scale = np.broadcast_to(scene.vectors().scale[0], targets.shape)
    inputs = signals(read, scene.scales(scene.sensors))
    codes, saturated = SIGNAL.quantise(inputs, "inputs")
    found = replace(scene.vectors(), targets=targets, scale=scale)
    return replace(found, inputs=inputs, codes=codes, saturated=saturated)


OWN = np.array([[force, place] for force in (10.0, 20, 30) for place in (50.0, 120, 180, 250)])


def rail_errors(vectors: Vectors, samples: np.ndarray) -> np.ndarray:
    return vectors.percent_errors(rail().process_real(samples)).mean(axis=0)


@pytest.mark.parametrize(
    ("chosen", "times", "noise", "drift", "least", "most"),
    [
        ("proposed", 1, 0.005, 0.05, 0, 5),
        ("proposed", 4, 0.005, 0.05, 4, 5),
        ("proposed", 1, 0.02, 0.05, 0, 0),
        ("proposed", 4, 0.005, 0, 0, 0),
        ("own", 1, 0.01, 0.05, 0, 5),
    ],
)
def test_a_correction_helps_or_is_not_written(
    chosen: str, times: int, noise: float, drift: float, least: int, most: int
) -> None:
    """Two gains have drifted by 5 %. There are five draws of noise, and 300 unseen rows.

    An earlier fit, which ignored noise, made the force worse in all five draws.
    """
    # Noise of each reading, in its unit.
    factors = np.array([s.factor for s in rail().scales(rail().sensors)])
    recorded = Sensitivity.of(rail(), noise / factors)
    eight = [recorded.recorded.targets[one.row] for one in islice(proposed(recorded, times), 8)]
    touches = {"proposed": rail().in_units(np.array(eight)), "own": OWN}[chosen]
    written = 0
    for draw in range(5):
        rng = np.random.default_rng(draw)
        read = touched(np.repeat(touches, times, axis=0), noise, drift, rng)
        there, _ = grouped(read, np.repeat(np.arange(float(len(touches))), times))
        found = fit(recorded, there)
        ahead = outlook(recorded, found)
        # What the placements do not tell is in both errors, so a correction is expected to gain,
        # but for the curves of the outputs.
        assert (ahead.before > 0.95 * ahead.after).all()
        if not helps(recorded, there, found, left_out(recorded, there, found)):
            continue
        written += 1
        fresh = np.column_stack([rng.uniform(6, 30, 300), rng.uniform(11, 289, 300)])
        new = touched(fresh, noise, drift, rng)
        before = rail_errors(new, new.inputs)
        after = rail_errors(new, readings(new.inputs, recorded.correction(found.theta)))
        assert after[0] < before[0]
        assert after.mean() < before.mean()
    assert least <= written <= most


def placements(folder: Path, scene: Scene, count: int = 20) -> Path:
    """A CSV of known placements, with readings of drifted sensors in their units."""
    vectors, rng = scene.vectors(), np.random.default_rng(4)
    drifted = DRIFT.of(vectors.inputs, rng)
    rows = rng.permutation(len(drifted))[:count]
    path = folder / "placements.csv"
    inputs = readings(drifted[rows], scene.scales(scene.sensors))
    targets = scene.in_units(vectors.targets[rows])
    write_table(path, [*scene.sensors, *scene.outputs], np.hstack([inputs, targets]), 9)
    return path


def test_the_copy_has_corrected_weights_and_says_so(tmp_path: Path, capsys) -> None:
    scene = load_scene("digit")
    call("recalibrate", scene.path, placements(tmp_path, scene), tmp_path / "to")
    copy = load_scene(str(tmp_path / "to" / "digit.toml"))
    printed = capsys.readouterr().out
    for name in scene.outputs:
        line = rf"^{name} +(\S+) +(\S+) +(\S+) +>99 %$"
        before, after, recorded = map(float, re.search(line, printed, re.M).groups())
        assert before > 5 * after
        assert after < 2 * recorded
    told = read_provenance(copy.weights_paths[1])
    assert told["recalibrated_from"] == "digit"
    assert told["placements"] == 20
    assert told["optimiser"] == "levenberg-marquardt"
    gains = np.array([told["correction"][name]["gain"] for name in scene.sensors])
    offsets = np.array([told["correction"][name]["offset"] for name in scene.sensors])
    for old, new in zip(scene.mlps(), copy.mlps(), strict=True):
        (first, second), (one, two) = old.layers, new.layers
        assert one.weights[:, :4] == pytest.approx(first.weights[:, :4] * gains)
        assert one.biases == pytest.approx(first.biases + first.weights[:, :4] @ offsets)
        assert (one.weights[:, 4:] == first.weights[:, 4:]).all()
        assert (two.weights == second.weights).all()
        assert (two.biases == second.biases).all()
    correction = [Scale(o, g) for o, g in zip(offsets, gains, strict=True)]
    now = now_read(scene, correction, scene.vectors().inputs)
    assert copy.vectors().inputs == pytest.approx(now, abs=1e-8)
    assert readings(now, correction) == pytest.approx(scene.vectors().inputs)
    ours, theirs = (
        SIGNAL.to_real(one.twin().core.process(one.vectors().codes)) for one in (scene, copy)
    )
    assert np.abs(ours - theirs).mean() < 5e-4


OWN_NAMES = [
    ("data.file = 'a/r.csv'\nnetwork.weights = \"a/w.mat\"", ("r.csv", "w.npz")),
    (
        "network = { weights = [ # two\n  'a/w.mat',\n'n.npz/y'] }\ndata.recordings=['a/r.csv']",
        (["r.csv"], ["w.npz", "n.npz/y"]),
    ),
    (
        "[data]\nsource = \"get 'a/r.csv'\"\nfile = 'a/r.csv' # 'a/r.csv'\n"
        "[network]\nweights='n.npz'",
        ("r.csv", "n.npz"),
    ),
    ("data.file = '''r.csv'''\nnetwork.weights = 'n.npz'", None),
    ("data = { file = 'r.csv', source = \"get, 'r.csv'\" }\nnetwork.weights = 'n.npz'", None),
]


@pytest.mark.parametrize(("text", "names"), OWN_NAMES)
def test_a_copy_names_its_own_files_and_is_otherwise_the_scene(
    tmp_path: Path, text: str, names: tuple[object, object] | None
) -> None:
    scene = SimpleNamespace(path=tmp_path / "own.toml", name="own")
    scene.path.write_text(text)
    if names is None:
        said = "own.toml: got data.file or network.weights in a form that cannot be replaced"
        with pytest.raises(InputError, match=said):
            _scene_text(scene, "new.csv")
        return
    wanted, found = tomllib.loads(text), tomllib.loads(_scene_text(scene, "r.csv"))
    (key,) = {"file", "recordings"} & set(wanted["data"])
    wanted["data"][key], wanted["network"]["weights"] = names
    assert found == wanted


def test_without_placements_some_are_proposed(capsys) -> None:
    call("recalibrate", "digit")
    printed = capsys.readouterr().out
    scene, recorded = digit(0.001)
    for number, one in enumerate(islice(proposed(recorded), 8), start=1):
        load, position = scene.vectors().targets[one.row, :2]
        after = " +".join(f"{error:.2f}" for error in one.expected.after)
        line = rf"^ +{number} +{after}  load {load:g}, position {position:g},"
        assert re.search(line, printed, re.M), line
    found = plan(recorded)
    assert f"{len(found.placements)} placements that tell most, read once, are enough" in printed
    assert "noise of a reading: 0.001 (training.noise of digit.toml)" in printed


def rail_file(folder: Path, vectors: Vectors) -> Path:
    """Touches of the rail as a CSV. Equal touches are one placement."""
    scene, path = rail(), folder / "touches.csv"
    inputs = readings(vectors.inputs, scene.scales(scene.sensors))
    _, which = np.unique(vectors.targets, axis=0, return_inverse=True)
    rows = np.column_stack([inputs, scene.in_units(vectors.targets), which.ravel()])
    write_table(path, [*scene.sensors, *scene.outputs, "placement"], rows, 9)
    return path


def test_noise_is_given_or_estimated_or_asked_for(tmp_path: Path, capsys) -> None:
    """The networks of this rail were not trained for noise."""
    shutil.copytree(RAIL.parent, tmp_path / "rail")
    scene, rng = tmp_path / "rail" / "rail.toml", np.random.default_rng(2)
    scene.write_text(scene.read_text().replace("noise = 0.002", ""))
    once = rail_file(tmp_path, touched(OWN, 0.004, 0.2, rng))
    with pytest.raises(InputError, match=r"touches.csv: got 12 readings of 12 placements, expec"):
        call("recalibrate", scene, once, tmp_path / "to")
    call("recalibrate", scene, once, tmp_path / "to", "--noise=0.004")
    assert "noise of a reading: 0.004 (NOISE)" in capsys.readouterr().out
    often = rail_file(tmp_path, touched(np.repeat(OWN, 5, axis=0), 0.004, 0.2, rng))
    call("recalibrate", scene, often, tmp_path / "to2")
    printed = capsys.readouterr().out
    assert "12 placements, 60 readings of each sensor" in printed
    found = re.search(r"noise of a reading: (.*) \(estimated from repeats\)", printed)
    noises = [float(part.split()[1]) for part in found[1].split(", ")]
    assert noises == pytest.approx([0.004] * 5, rel=0.35)
    told = read_provenance(tmp_path / "to2" / "rail.npz" / "force")
    assert (told["placements"], told["readings"]) == (12, 60)
    call("recalibrate", scene)
    assert "noise of a reading: not known" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("touches", "drift", "message"),
    [
        (OWN[:3], 0.05, r"these placements tell too little for a sure gain\. \d+ placements"),
        (np.repeat(OWN, 4, axis=0), 0, "(show none from which|come out no closer)"),
    ],
)
def test_what_surely_gains_nothing_is_not_written(
    touches: np.ndarray, drift: float, message: str, tmp_path: Path, capsys
) -> None:
    """The errors of left-out placements and the expected errors are printed all the same.

    Errors of placements that were fitted are not printed.
    """
    path = rail_file(tmp_path, touched(touches, 0.002, drift, np.random.default_rng(1)))
    with pytest.raises(InputError, match=rf"touches.csv: nothing written: .*{message}"):
        call("recalibrate", RAIL, path, tmp_path / "to", "--noise=0.002")
    assert not (tmp_path / "to").exists()
    printed = capsys.readouterr().out
    assert len(re.findall(r"^ +\d+ +\S+ > ", printed, re.M)) == len(np.unique(touches, axis=0))
    assert "with a correction fitted to all others" in printed
    assert re.search(r"^all +\d+ %$", printed, re.M)


def test_a_placement_that_is_noted_wrongly_is_named(tmp_path: Path) -> None:
    places = np.linspace(60, 240, 7)
    touches = np.array([[force, place] for force in (12.0, 24) for place in places])
    read = touched(touches, 0.002, 0.2, np.random.default_rng(1))
    targets = read.targets.copy()
    targets[9] = signals(np.array([24.0, 220]), rail().scales(rail().outputs))
    path = rail_file(tmp_path, replace(read, targets=targets))
    message = r"place of placement 10 \(force 24, place 220\) is off by"
    with pytest.warns(UserWarning, match=message), suppress(InputError):
        call("recalibrate", RAIL, path, tmp_path / "to", "--noise=0.002")
