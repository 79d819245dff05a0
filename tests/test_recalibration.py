"""make recalibrate: gain and offset of each sensor from known placements."""

from __future__ import annotations

import re
import tomllib
from dataclasses import replace
from functools import cache
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from golden.disturbance import Disturbance
from golden.network_files.network_file import provenance_path
from golden.precision import SIGNAL
from golden.recalibration.__main__ import main
from golden.recalibration.choice import (
    MOST_ADDED,
    information_of,
    proposal,
    proposed,
    refuse_unsure,
)
from golden.recalibration.fit import BEFOREHAND, Sensitivity, fit, outputs_and_slopes
from golden.recalibration.folder import now_read
from golden.scene import Scene, Vectors, load_scene, scene_path
from golden.scene.image import scene_image
from golden.scene.scale import Scale, readings
from golden.scene.write_image import hardware_of
from golden.table import read_table, write_table
from hdl.export.exporter import export

DRIFT = Disturbance(gain=0.03, offset=0.02)


@cache
def digit() -> tuple[Scene, Sensitivity]:
    scene = load_scene("digit")
    return scene, Sensitivity.of(scene)


def at(scene: Scene, rows: np.ndarray, inputs: np.ndarray) -> Vectors:
    """Rows of the recording as placements with other readings."""
    vectors = scene.vectors()
    return replace(
        vectors, inputs=inputs[rows], targets=vectors.targets[rows], scale=vectors.scale[rows]
    )


def mean_errors(scene: Scene, samples: np.ndarray) -> np.ndarray:
    return scene.vectors().percent_errors(scene.process_real(samples)).mean(axis=0)


@pytest.mark.parametrize("name", ["digit", "digit-single", "digit-multiple", "digit-load"])
def test_slopes_are_finite_differences_of_the_outputs(name: str) -> None:
    scene, step = load_scene(name), 1e-6
    samples = scene.vectors().inputs
    outputs, slopes = outputs_and_slopes(scene, samples)
    assert outputs == pytest.approx(scene.process_real(samples), abs=1e-12)
    for sensor in range(len(scene.sensors)):
        moved = step * np.eye(len(scene.sensors))[sensor]
        higher, lower = (scene.process_real(samples + sign * moved) for sign in (1, -1))
        assert slopes[:, :, sensor] == pytest.approx((higher - lower) / (2 * step), abs=1e-6)


def test_what_a_placement_tells_is_how_its_errors_move() -> None:
    """By the correction at either end of what a sensor read, in parts of the output's own error."""
    scene, recorded = digit()
    vectors, step = scene.vectors(), 1e-6
    for k in range(8):
        moved = np.zeros_like(vectors.inputs)
        moved[:, k % 4] = step * recorded.ends(vectors.inputs)[:, k]
        higher, lower = (scene.process_real(vectors.inputs + s * moved) for s in (1, -1))
        expected = 100 * (higher - lower) / (2 * step) / vectors.scale / recorded.error
        assert recorded.tells[:, :, k] == pytest.approx(expected, rel=1e-4, abs=1e-3)


def test_a_drift_is_undone_where_the_outputs_are_the_networks_own() -> None:
    """Nothing but the drift is between readings and outputs, so its inverse is what is found."""
    scene, recorded = digit()
    vectors = scene.vectors()
    exact = scene.process_real(vectors.inputs)
    drift = [Scale(0.02, 1.03), Scale(-0.03, 0.98), Scale(0.01, 1.0), Scale(0.0, 0.96)]
    drifted = readings(vectors.inputs, drift)
    placements = replace(at(scene, np.arange(0, 143, 5), drifted), targets=exact[::5])
    for found, known in zip(fit(scene, recorded, placements), drift, strict=True):
        assert found.factor == pytest.approx(1 / known.factor, abs=1e-3)
        assert found.offset == pytest.approx(-known.offset / known.factor, abs=1e-3)


def test_twenty_placements_at_random_bring_the_errors_back() -> None:
    """From several percent to little above those of sensors that have not drifted, for ten drifts:
    a descent from no correction alone ends elsewhere for some of them."""
    scene, recorded = digit()
    vectors, rng = scene.vectors(), np.random.default_rng(2)
    own = mean_errors(scene, vectors.inputs)
    before, after = [], []
    for _ in range(10):
        drifted = DRIFT.of(vectors.inputs, rng)
        placements = at(scene, rng.permutation(143)[:20], drifted)
        before.append(mean_errors(scene, drifted))
        after.append(mean_errors(scene, readings(drifted, fit(scene, recorded, placements))))
    assert np.mean(before, axis=0).min() > 10 * own.max()
    assert (np.mean(after, axis=0) < 1.4 * own).all()
    assert np.max(after) < 3 * own.max()


def test_a_start_from_none_alone_would_end_elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    """Why there are two."""
    scene, recorded = digit()
    vectors, worst = scene.vectors(), []
    drift = Scale(-0.08, 1.1), Scale(0.08, 0.9), Scale(0.08, 1.1), Scale(-0.08, 0.9)
    drifted = readings(vectors.inputs, drift)
    for _ in range(2):
        found = fit(scene, recorded, at(scene, np.arange(0, 143, 7), drifted))
        worst.append(mean_errors(scene, readings(drifted, found)).max())
        name = "golden.recalibration.fit._towards_recorded"
        monkeypatch.setattr(name, lambda *_: np.zeros(8))
    assert worst[0] < 1 < worst[1]


def test_the_first_proposed_has_the_largest_determinant() -> None:
    _, recorded = digit()
    known = np.zeros((8, 8))
    rows = []
    for row, information in islice(proposed(recorded, known), 3):
        base = np.eye(8) / BEFOREHAND**2 + known
        volumes = [np.linalg.det(base + t.T @ t) if i not in rows else 0
                   for i, t in enumerate(recorded.tells)]  # fmt: skip
        assert volumes[row] == pytest.approx(max(volumes), rel=1e-5)
        assert information == pytest.approx(known + recorded.tells[row].T @ recorded.tells[row])
        rows.append(row)
        known = information


@pytest.mark.parametrize("rows", [[3], [3] * 30, [0, 1, 2, 3, 4]])
def test_placements_that_leave_a_sensor_open_are_refused(rows: list[int]) -> None:
    """Few, one alone however often, some with one load; with what is proposed they are enough."""
    scene, recorded = digit()
    vectors = scene.vectors()
    information = information_of(scene, recorded, at(scene, np.array(rows), vectors.inputs))
    with pytest.raises(
        ValueError, match=r"open: .* expected at most 1; add such as load"
    ) as raised:
        refuse_unsure(scene, recorded, information, len(rows))
    assert f"got {len(rows)} placements" in str(raised.value)
    assert any(sensor in str(raised.value) for sensor in scene.sensors)
    rows = rows + [row for row, _ in proposal(recorded, information)]
    more = information_of(scene, recorded, at(scene, np.array(rows), vectors.inputs))
    refuse_unsure(scene, recorded, more, len(rows))


def test_the_sensor_that_is_open_is_named() -> None:
    """Placements at which sensor 3 reads nothing but its offset tell nothing of its gain."""
    scene, recorded = digit()
    vectors = scene.vectors()
    rows = np.flatnonzero(np.abs(vectors.inputs[:, 2]) < 0.0085)
    assert len(rows) > 20
    information = information_of(scene, recorded, at(scene, rows, vectors.inputs))
    with pytest.raises(ValueError, match="leave gain and offset of sensor3 open"):
        refuse_unsure(scene, recorded, information, len(rows))


@pytest.mark.parametrize("name", ["digit-load", "digit-parallel", "swing-single"])
def test_any_scene_gets_a_proposal_that_is_enough(name: str) -> None:
    scene = load_scene(name)
    recorded = Sensitivity.of(scene)
    nothing = np.zeros((2 * len(scene.sensors),) * 2)
    found = proposal(recorded, nothing)
    assert found[-1][1] <= MOST_ADDED
    parts = [part for _, part in found]
    assert parts == sorted(parts, reverse=True)


def placements(folder: Path, scene: Scene, count: int = 20) -> Path:
    """A CSV of known placements of sensors that have drifted, in their units."""
    vectors, rng = scene.vectors(), np.random.default_rng(4)
    drifted = DRIFT.of(vectors.inputs, rng)
    rows = rng.permutation(len(drifted))[:count]
    path = folder / "placements.csv"
    inputs = readings(drifted[rows], scene.scales(scene.sensors))
    targets = scene.in_units(vectors.targets[rows])
    write_table(path, [*scene.sensors, *scene.outputs], np.hstack([inputs, targets]), 9)
    return path


def recalibrated(folder: Path, scene: Scene, monkeypatch: pytest.MonkeyPatch) -> Scene:
    """The copy that the command writes."""
    words = [
        "make recalibrate",
        str(scene.path),
        str(placements(folder, scene)),
        str(folder / "to"),
    ]
    monkeypatch.setattr("sys.argv", words)
    main()
    return load_scene(str(folder / "to" / f"{scene.name}.toml"))


def same_outputs(scene: Scene, copy: Scene) -> None:
    """The copy does to its recording what the scene does to its own, but for roundings."""
    ours, theirs = (
        SIGNAL.to_real(one.twin().core.process(one.vectors().codes)) for one in (scene, copy)
    )
    assert np.abs(ours - theirs).mean() < 5e-4


def test_the_copy_has_corrected_weights_and_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = load_scene("digit")
    copy = recalibrated(tmp_path, scene, monkeypatch)
    printed = capsys.readouterr().out
    for name in scene.outputs:
        before, after, recorded = map(
            float, re.findall(rf"^{name} +(\S+) +(\S+) +(\S+)", printed, re.M)[0]
        )
        assert before > 5 * after
        assert after < 2 * recorded
    told = tomllib.loads(provenance_path(copy.weights_paths[1]).read_text())
    assert told["recalibrated_from"] == "digit"
    assert told["placements"] == 20
    assert told["optimiser"] == "levenberg-marquardt"
    gains = np.array([told["correction"][name]["gain"] for name in scene.sensors])
    offsets = np.array([told["correction"][name]["offset"] for name in scene.sensors])
    for old, new in zip(scene.mlps(), copy.mlps(), strict=True):
        assert new.w1[:, :4] == pytest.approx(old.w1[:, :4] * gains)
        assert new.b1 == pytest.approx(old.b1 + old.w1[:, :4] @ offsets)
        assert (new.w1[:, 4:] == old.w1[:, 4:]).all()
        assert (new.w2 == old.w2).all()
        assert (new.b2 == old.b2).all()
    correction = [Scale(o, g) for o, g in zip(offsets, gains, strict=True)]
    now = now_read(scene, correction, scene.vectors().inputs)
    assert copy.vectors().inputs == pytest.approx(now, abs=1e-8)
    assert readings(now, correction) == pytest.approx(scene.vectors().inputs)
    same_outputs(scene, copy)


def test_a_scene_in_raw_units_is_recalibrated_in_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Sensors of 0 to 5 V: their networks on readings, the correction on signals."""
    shipped = load_scene("digit-load")
    path = shipped.data_path
    table = read_table(path, [*shipped.sensors, "load", "position"])
    table[:, :4] = 2.5 + 2.5 * table[:, :4]
    write_table(tmp_path / "raw.csv", [*shipped.sensors, "load", "position"], table, 6)
    text = re.sub(r'file = ".*"', 'file = "raw.csv"', shipped.path.read_text())
    text = re.sub(r"weights = .*", 'weights = "raw.npz"', text)
    scales = ", ".join(f"{name} = {{ offset = 2.5, factor = 2.5 }}" for name in shipped.sensors)
    text = text.replace("\n[network]", f"scale = {{ {scales} }}\n\n[network]")
    (tmp_path / "raw.toml").write_text(text)
    mlp = shipped.mlps()[0]
    np.savez(
        tmp_path / "raw.npz", w1=mlp.w1 / 2.5, b1=mlp.b1 - mlp.w1.sum(axis=1), w2=mlp.w2, b2=mlp.b2
    )
    scene = load_scene(str(tmp_path / "raw.toml"))
    assert mean_errors(scene, scene.vectors().inputs).max() < 1
    copy = recalibrated(tmp_path, scene, monkeypatch)
    assert read_table(copy.data_path, scene.sensors).min() >= 0
    same_outputs(scene, copy)


def reloadable(folder: Path) -> Scene:
    """The digit's networks on an engine that can be reloaded."""
    path = scene_path("digit")
    text = path.read_text().replace('design = "engine"', 'design = "engine"\nreload = true')
    text = re.sub(r'"([^"]+\.(?:csv|npz))"', lambda f: f'"{(path.parent / f[1]).resolve()}"', text)
    (folder / "digit.toml").write_text(text)
    return load_scene(str(folder / "digit.toml"))


def test_an_engine_gets_a_new_image_and_no_new_hardware(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = reloadable(tmp_path)
    copy = recalibrated(tmp_path, scene, monkeypatch)
    images = [scene_image(one, hardware_of(scene)) for one in (scene, copy)]
    assert images[0].sizes == images[1].sizes
    assert len(images[0].words) == len(images[1].words)
    assert images[0].to_bytes() != images[1].to_bytes()
    exported = []
    for n, one in enumerate((scene, copy)):
        folder = tmp_path / f"vhdl{n}"
        export(one, "vhdl", folder)
        # Beside the entities stand a test bench and its frames.
        order = (folder / "compile_order.txt").read_text().split()
        exported.append({name: (folder / name).read_bytes() for name in order})
    assert exported[0]
    assert exported[0] == exported[1]


def test_the_scene_itself_is_not_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = load_scene("digit")
    csv = placements(tmp_path, scene)
    for target in (scene.path, scene.path.parent, scene.path.with_name("other.toml")):
        monkeypatch.setattr("sys.argv", ["make recalibrate", "digit", str(csv), str(target)])
        with pytest.raises(ValueError, match="expected another: its networks would be replaced"):
            main()


def test_placements_are_checked_as_a_recording_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "placements.csv"
    header = "sensor1,sensor2,sensor3,sensor4,load,position,width,shape"
    for text, message in (
        ("sensor1,load\n0.1,0.9\n", "no column 'sensor2'"),
        (f"{header}\n0,0,0,0,2,0.1,0.9,0.45\n", "column 'load': got a target of 2"),
        (f"{header}\n0,9,0,0,0.9,0.1,0.9,0.45\n", "column 'sensor2': got 1 of 1 readings outside"),
    ):
        path.write_text(text)
        monkeypatch.setattr(
            "sys.argv", ["make recalibrate", "digit", str(path), str(tmp_path / "t")]
        )
        with pytest.raises(ValueError, match=rf"placements.csv: {message}"):
            main()
        assert not (tmp_path / "t").exists()


def test_without_placements_some_are_proposed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["make recalibrate", "digit"])
    main()
    printed = capsys.readouterr().out
    scene, recorded = digit()
    rows = [row for row, _ in proposal(recorded, np.zeros((8, 8)), 8)]
    assert len(rows) == 8
    for row in rows:
        load, position = scene.vectors().targets[row, :2]
        assert f"load {load:g}, position {position:g}" in printed
