"""Tests which sensors an output needs, by training without them and by held-out rows."""

from dataclasses import replace

import numpy as np
import pytest

from golden.input_error import InputError
from tactus.report.page import left_out as page
from tactus.rig.sensors_needed import (
    Effort,
    Recording,
    held_out,
    one_after_another,
    recording_of,
    splits_of,
    without_each,
)
from tactus.scene import load_scene
from tactus.scene.disturbance import Disturbance
from tactus.train.descent.split import Split, split_rows

QUICK = Effort(hidden=3, starts=2, steps=60, patience=20)
ROWS = 120


def made(*sensors: str) -> Recording:
    """Sensors a and b, a copy of a, or noise. y depends on a and b, and z only on b."""
    rng = np.random.default_rng(5)
    a, b, noise = rng.uniform(-1, 1, (3, ROWS))
    columns = {"a": a, "b": b, "copy": 2 * a + 1, "noise": noise}
    targets = np.column_stack([np.tanh(a) + 0.5 * b, 0.8 * b])
    readings = np.column_stack([columns[name] for name in sensors])
    return Recording(readings, targets, np.ones_like(targets), sensors, ("y", "z"))


@pytest.fixture(scope="module")
def splits() -> list[Split]:
    return [split_rows(ROWS, seed) for seed in (1, 2)]


def test_a_sensor_of_noise_is_not_needed_and_the_others_are(splits: list[Split]) -> None:
    whole, *without = without_each(made("a", "b", "noise"), splits, QUICK)
    assert [step.dropped for step in (whole, *without)] == ["", "a", "b", "noise"]
    means = {step.dropped: step.errors.mean.mean(axis=0) for step in (whole, *without)}
    assert (means["noise"] < 2).all()
    assert (means[""] < 2).all()
    # z does not depend on a.
    assert means["a"][0] > 20
    assert means["a"][1] < 2
    assert (means["b"] > 10).all()


def test_what_tells_least_goes_first(splits: list[Split]) -> None:
    steps = one_after_another(made("noise", "a", "b"), splits, QUICK)
    assert [step.dropped for step in steps][:2] == ["", "noise"]
    assert [len(step.kept) for step in steps] == [3, 2, 1]
    assert steps[1].kept == ("a", "b")


def test_of_two_that_tell_the_same_one_is_needed(splits: list[Split]) -> None:
    recording = made("a", "b", "copy")
    each = without_each(recording, splits, QUICK)
    alone = {step.dropped: step.errors.mean.max() for step in each}
    assert max(alone["a"], alone["copy"]) < 2
    order = one_after_another(recording, splits, QUICK, known=each)
    assert order[1].dropped in ("a", "copy")
    # The result of the earlier training is used again.
    assert any(order[1] is step for step in each)
    assert order[2].errors.mean.max() > 20


def test_what_was_trained_before_is_what_would_be_found(splits: list[Split]) -> None:
    recording = made("a", "b")
    known = without_each(recording, splits[:1], QUICK)
    for step, other in zip(
        one_after_another(recording, splits[:1], QUICK, known=known),
        one_after_another(recording, splits[:1], QUICK),
        strict=True,
    ):
        assert step.kept == other.kept
        np.testing.assert_array_equal(step.errors.mean, other.errors.mean)


def test_a_past_sample_goes_with_its_sensor() -> None:
    recording = replace(made("a", "b", "noise"), sensors=("a", "b", "a"))
    assert recording.names == ("a", "b")
    assert recording.columns(["a"]).tolist() == [0, 2]


@pytest.mark.parametrize(("kept", "got"), [([], "no sensor"), (["a", "c"], "c")])
def test_sensors_that_are_not_there_are_refused(splits, kept: list[str], got: str) -> None:
    with pytest.raises(InputError, match=f"kept: got {got}, expected some of a, b"):
        held_out(made("a", "b"), splits, kept, QUICK)


def test_the_last_sensor_is_not_left_out(splits: list[Split]) -> None:
    assert [step.kept for step in without_each(made("b"), splits[:1], QUICK)] == [("b",)]


def test_noise_on_the_readings_is_noise_in_the_errors(splits: list[Split]) -> None:
    recording, noisy = made("a", "b"), replace(QUICK, disturbance=Disturbance(noise=0.2))
    recorded_errors = held_out(recording, splits[:1], ("a", "b"), QUICK)
    errors = held_out(recording, splits[:1], ("a", "b"), noisy)
    assert (errors.mean > 4 * recorded_errors.mean).all()
    again = held_out(recording, splits[:1], ("a", "b"), noisy)
    np.testing.assert_array_equal(errors.mean, again.mean)


def test_a_scene_gives_its_recording_and_its_splits() -> None:
    scene = load_scene("digit")
    recording = recording_of(scene)
    assert recording.names == scene.sensors
    np.testing.assert_allclose(recording.readings, scene.vectors().inputs)
    first, second = splits_of(scene, (1, 2))
    assert sorted(np.concatenate(list(vars(first).values()))) == list(range(len(recording.scale)))
    assert set(first.test) != set(second.test)
    past = recording_of(load_scene("swing-window"))
    assert len(past.sensors) == past.readings.shape[1] > len(past.names)


def test_a_leaner_program_takes_fewer_words_and_clocks() -> None:
    rows = [line.split("|")[2:4] for line in page.program_rows().splitlines()[2:]]
    whole, *others = [(int(words), int(clocks)) for words, clocks in rows]
    assert all(words < whole[0] and clocks < whole[1] for words, clocks in others)
