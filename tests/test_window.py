"""Tests past frames as inputs."""

import numpy as np

from golden.trained.window import Tap, Window


def test_taps_are_the_newest_first_then_by_sensor() -> None:
    window = Window(((0, 4), (0,), (2, 4)))
    assert window.taps == (Tap(0, 0), Tap(1, 0), Tap(2, 2), Tap(0, 4), Tap(2, 4))
    assert window.past == 4
    assert not window.plain
    assert Window(((0,), (0,))).plain


def test_frames_are_those_with_a_whole_past() -> None:
    samples = 10 * np.arange(7)[:, np.newaxis] + np.arange(2)
    frames = Window(((0, 3), (1,))).frames(samples)
    assert frames.tolist() == [[10 * t, 10 * (t - 1) + 1, 10 * (t - 3)] for t in range(3, 7)]


def test_without_a_past_a_frame_is_itself() -> None:
    samples = np.arange(6).reshape(3, 2)
    assert (Window(((0,), (0,))).frames(samples) == samples).all()


def test_fewer_frames_than_past_give_none() -> None:
    assert Window(((0, 5),)).frames(np.zeros((5, 1))).shape == (0, 2)
