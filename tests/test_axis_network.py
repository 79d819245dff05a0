"""Tests the twin of axis_network, and the memory that it relies on."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from golden.input_error import InputError
from golden.layers.argmax import Argmax, ArgmaxTree
from golden.networks.axis_network import TDATA, AxisNetwork
from golden.numbers.fixed import Fix
from tactus.verify.benches.collected import CASES
from tactus.verify.benches.written import scene_of

AXIS = ("axis", "least-axis", "axis-cascade", "slow-axis-cascade", "axis-multiple")


@pytest.mark.parametrize("name", AXIS)
def test_frames_are_those_of_the_network(tmp_path: Path, name: str) -> None:
    design = scene_of(CASES[name], tmp_path, name).twin()
    assert isinstance(design, AxisNetwork)
    rng = np.random.default_rng(1)
    frames = rng.integers(-8192, 8192, (20, design.inputs))
    last = np.zeros(frames.shape, dtype=bool)
    last[:, -1] = True
    # The bits above the sample may have any value.
    padded = frames + 16384 * rng.integers(-1, 2, frames.shape)
    padded = np.clip(padded, TDATA.low, TDATA.high)
    kept = (padded - frames) % 16384 == 0
    sent = np.where(kept, padded, frames)
    data, closes, errors = design.process_stream(sent.ravel(), last.ravel())
    expected = design.network.process(frames)
    assert np.array_equal(data.reshape(expected.shape), expected)
    assert np.array_equal(np.flatnonzero(closes) + 1, design.outputs * np.arange(1, 21))
    assert errors == 0


def test_wrong_frames_give_nothing(tmp_path: Path) -> None:
    design = scene_of(CASES["axis-cascade"], tmp_path, "axis-cascade").twin()
    # With two samples in a frame: too short, good, as long as the frames of the cascade, good.
    last = [1, 0, 1, 0, 0, 0, 1, 0, 1]
    data, _, errors = design.process_stream(np.arange(9), last)
    expected = design.network.process([[1, 2], [7, 8]])
    assert np.array_equal(data, expected.ravel())
    assert errors == 2


@pytest.mark.parametrize("name", AXIS)
def test_credits_cover_the_way_through_and_no_more(tmp_path: Path, name: str) -> None:
    design = scene_of(CASES[name], tmp_path, name).twin()
    frames = design.frames_under_way
    # From the last sample to the clock in which the credit is returned. This is one clock after the
    # last output is fetched, when that output is on the port.
    held = design.latency + design.outputs - 1
    assert (frames - 1) * design.interval < held <= frames * design.interval


def test_the_winner_is_the_tuser_of_the_last_output(tmp_path: Path) -> None:
    design = scene_of(CASES["winner-axis"], tmp_path, "winner-axis").twin()
    outputs = [[0, 5, -3, 5, 1], [-8192, -8192, -8192, -8192, 8191]]
    assert design.winners(outputs).tolist() == [1, (16383 << 16) + 4]
    plain = scene_of(CASES["axis"], tmp_path, "axis").twin()
    assert "m_axis_tuser" not in {port.name for port in plain.ports}
    assert design.latency == plain.latency + 1
    with pytest.raises(InputError, match="axis_network: looks for no largest output"):
        plain.winners(outputs)


FMT = Fix(5, 3)


@given(st.lists(st.integers(FMT.low, FMT.high), min_size=2, max_size=6))
def test_the_winner_is_the_first_of_the_largest_and_its_margin_what_is_left(codes) -> None:
    index, margin = Argmax(FMT, 6).process(codes)
    best = sorted(codes)
    assert index == codes.index(best[-1])
    assert margin == best[-1] - best[-2]


@given(st.lists(st.integers(FMT.low, FMT.high), min_size=2, max_size=9))
def test_a_tree_decides_as_the_block_that_takes_one_output_after_the_other(codes) -> None:
    tree = ArgmaxTree(FMT, len(codes))
    index, margin = tree.process(codes)
    best = sorted(codes)
    assert (index, margin) == (codes.index(best[-1]), best[-1] - best[-2])
    assert 1 << tree.levels >= len(codes) > 1 << tree.levels - 1
