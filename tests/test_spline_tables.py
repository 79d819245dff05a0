"""Tests networks of learned functions in integers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from golden.input_error import InputError
from golden.precision import SIGNAL
from golden.splines.basis import Basis
from golden.splines.edges import CURVED, STRAIGHT, Edges
from golden.splines.network import starting
from golden.splines.tables import tabulated
from golden.splines.training import Learned, Settings


def learned(edges: Edges | None = None) -> Learned:
    bases = [Basis(-1.0, 1.0, 4)] * 3
    network = starting(bases, 4, 2, 2, np.random.default_rng(5))
    network = replace(network, biases=np.array([0.1, -0.05]))
    edges = edges or Edges.curved(network.shape)
    return Learned(network, edges, Settings(2, 4, 4, 0.1), 10)


def frames() -> np.ndarray:
    return np.random.default_rng(1).integers(SIGNAL.low, SIGNAL.high + 1, (300, 3))


def misses(model: Learned, segments: int) -> np.ndarray:
    codes = frames()
    real = SIGNAL.to_real(codes)
    found = tabulated(model, real, segments).process(codes)
    return np.abs(found - 2.0**SIGNAL.frac * model.process(real))


def test_more_segments_come_nearer() -> None:
    """Lines err by the square of the width of a segment, down to the rounding of the output."""
    worst = [misses(learned(), segments).max() for segments in (4, 8, 16, 256)]
    assert worst[0] > 2.5 * worst[1] > 6 * worst[2]
    assert worst[3] <= 1.0


def test_straight_edges_take_no_table() -> None:
    edges = Edges(np.full((2, 3), STRAIGHT), np.full((2, 2), STRAIGHT))
    model = learned(edges)
    network = model.network
    freedom = edges.freedom(network)
    straight = freedom @ np.linalg.lstsq(freedom, network.packed())[0]
    model = replace(model, network=network.unpacked(straight))
    assert misses(model, 8).max() <= 1.0
    assert tabulated(model, SIGNAL.to_real(frames()), 8).words == 0


def test_a_line_is_as_far_above_its_function_as_below() -> None:
    edges = Edges(np.full((2, 3), STRAIGHT), np.full((2, 2), CURVED))
    model = learned(edges)
    parabola = np.broadcast_to(model.network.hidden.centres**2, model.network.second.shape)
    line = np.broadcast_to(0.2 * model.network.bases[0].centres, model.network.first.shape)
    model = replace(model, network=replace(model.network, first=line, second=parabola * 0.4))
    codes = frames()
    real = SIGNAL.to_real(codes)
    off = SIGNAL.to_real(tabulated(model, real, 16).process(codes)) - model.process(real)
    assert off.max() > 0.001
    assert off.max() == pytest.approx(-off.min(), rel=0.2)


def test_words_are_those_of_curved_edges() -> None:
    model = learned(Edges.curved((3, 2, 2)).with_kind(0, STRAIGHT))
    assert int((model.edges.kinds == CURVED).sum()) == 9
    assert tabulated(model, SIGNAL.to_real(frames()), 16).words == 9 * 16


@pytest.mark.parametrize("segments", [1, 12])
def test_an_impossible_number_of_segments_is_refused(segments: int) -> None:
    with pytest.raises(InputError, match=f"segments: got {segments}"):
        tabulated(learned(), SIGNAL.to_real(frames()), segments)
