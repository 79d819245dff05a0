"""Tests past frames as inputs, and the twins of frame_window and windowed."""

import numpy as np
import pytest

from golden.input_error import InputError
from golden.instruments.readout import Readout
from golden.networks.axis_network import AxisNetwork
from golden.networks.network import CHUNK, Network
from golden.networks.windowed import Windowed
from golden.numbers.fixed import Fix
from golden.sensing.frame_window import FrameWindow
from golden.trained.window import Window
from tactus.verify.benches.collected import CASES
from tactus.verify.benches.written import scene_of
from tb.common.case_library import PAST, WINDOW
from tb.common.cases import Case

FMT = Fix(14, 13)


def block(window: Window, slots=0, spacing=100) -> FrameWindow:
    return FrameWindow(FMT, window, slots, spacing)


@pytest.fixture(scope="module")
def past(tmp_path_factory) -> Windowed:
    design = scene_of(PAST, tmp_path_factory.mktemp("past"), "past").twin()
    assert isinstance(design, Windowed)
    return design


def random_frames(count: int, sensors: int) -> np.ndarray:
    return np.random.default_rng(1).integers(FMT.low, FMT.high + 1, (count, sensors))


def test_each_frame_is_followed_by_the_samples_of_its_window() -> None:
    frames = np.arange(8 * 2).reshape(8, 2)
    sent = block(Window(((0, 3), (1,)))).process(frames)
    # By delay: the newest frame's first sensor, the second one frame before, the first three.
    assert sent.tolist() == [[2 * t, 2 * t - 1, 2 * t - 6] for t in range(3, 8)]


@pytest.mark.parametrize("count", [0, 1, 5])
def test_nothing_leaves_before_the_past_is_whole(past: Windowed, count: int) -> None:
    frames = random_frames(count, past.inputs)
    assert past.frame_window.process(frames).shape == (0, 6)
    assert past.process(frames).shape == (0, past.outputs)


def test_the_network_takes_the_samples_of_the_window(past: Windowed) -> None:
    frames = random_frames(40, past.inputs)
    taps = WINDOW.frames(frames)
    results = past.process(frames)
    assert results.shape == (40 - past.past, past.outputs)
    assert np.array_equal(results, past.network.process(taps))
    assert past.core is past.network


def test_frames_beyond_a_chunk_have_the_frames_before_it_as_their_past(past: Windowed) -> None:
    frames = random_frames(CHUNK + 20, past.inputs)
    expected = past.network.process(WINDOW.frames(frames))
    assert np.array_equal(past.process(frames), expected)


@pytest.mark.parametrize("around", [AxisNetwork, Readout])
def test_what_stands_around_it_has_its_past(past: Windowed, around: type[Network]) -> None:
    network = around(network=past)
    frames = random_frames(30, past.inputs)
    assert network.past == past.past
    assert np.array_equal(network.process(frames), past.process(frames))


def test_outputs_come_behind_what_the_frame_window_sends(past: Windowed) -> None:
    window = past.frame_window
    assert window.elements == 6
    assert past.latency == window.latency + 5 + past.network.latency
    assert past.interval == past.network.interval
    assert past.busy == 0


@pytest.mark.parametrize(
    ("window", "words"),
    [
        (Window(((1,),)), 4),
        # 2 sensors with 7 past frames, the newest and the next frame need 18 words.
        (Window(((0, 7), (0,))), 32),
        # These are 16 words, but one is read while another is written, so one more is needed.
        (Window(((0, 2),) * 4), 32),
        (Window(((0, 64),) * 3), 256),
    ],
)
def test_the_ring_is_a_power_of_two_of_words(window: Window, words: int) -> None:
    found = block(window)
    assert found.words == words
    assert max(found.offsets) <= words - found.sensors


def test_frames_may_not_follow_faster_than_they_are_sent() -> None:
    window = Window(((0, 1), (0, 1)))
    assert block(window, slots=1, spacing=5).interval == 5
    for slots, spacing in ((1, 4), (0, 0), (-1, 100)):
        with pytest.raises(InputError, match=f"frame_window: got slots={slots} and spacing="):
            block(window, slots, spacing)


def test_an_instrument_leaves_its_engine_the_clocks_of_a_scan(tmp_path) -> None:
    """The engine keeps up with the frames."""
    case: Case = CASES["past-instrument"]
    twin = scene_of(case, tmp_path, "fast").twin()
    assert twin.past == 2
    assert twin.readout.interval <= twin.interval
