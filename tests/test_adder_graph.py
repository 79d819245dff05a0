"""Compares the design without a multiplier with real arithmetic, also for parallel networks."""

from __future__ import annotations

import numpy as np
import pytest

from golden.mlp import Mlp, tanh
from golden.networks.adder_graph import AdderGraph
from golden.networks.left_out import left_out
from golden.networks.oracle import error_bounds, exact
from golden.networks.settings import Settings
from golden.precision import EXACT, SIGNAL
from golden.scene import load_scene
from tb.common.cases import random_mlp
from tb.common.stimulus import corner_frames
from tb.report.measure.adder_errors import stages

ENDS = (SIGNAL.low, SIGNAL.high)
SHAPES = [((1, 1, 1), 1.0), ((3, 4, 2), 20.0), ((5, 3, 4), 0.3)]


def frames_of(inputs: int) -> np.ndarray:
    random = np.random.default_rng(2).integers(SIGNAL.low, SIGNAL.high + 1, (300, inputs))
    return np.concatenate([corner_frames(SIGNAL, inputs), random])


def off(design: AdderGraph, mlp: Mlp, outputs: slice) -> np.ndarray:
    """The distance of the outputs from real arithmetic that saturates, in real units."""
    frames = frames_of(design.inputs)
    real = mlp.process(SIGNAL.to_real(frames), tanh)
    ends = SIGNAL.to_real([SIGNAL.low, SIGNAL.high])
    results = SIGNAL.to_real(design.process(frames))[:, outputs]
    return np.abs(results - np.clip(real, *ends))


@pytest.mark.parametrize(("shape", "spread"), SHAPES)
@pytest.mark.parametrize("memory", ["block_ram", "logic"])
def test_outputs_are_within_their_bounds(
    shape: tuple[int, int, int], spread: float, memory: str
) -> None:
    mlp = random_mlp(shape, spread, 4)
    design = AdderGraph.of([mlp], Settings(EXACT, "bipartite", {"memory": memory}))
    bounds = error_bounds(design, mlp, EXACT, shape[0])
    assert (off(design, mlp, slice(None)) <= bounds).all()
    frames = frames_of(design.inputs)
    assert (exact(design, frames) == design.process(frames)).all()


def test_networks_side_by_side() -> None:
    mlps = [random_mlp((3, hidden, 1), spread, hidden) for hidden, spread in ((2, 1.0), (4, 9.0))]
    design = AdderGraph.of(mlps, Settings(EXACT, "bipartite"), "multiple")
    assert (design.inputs, design.outputs) == (3, 2)
    for i, mlp in enumerate(mlps):
        alone = AdderGraph.of([mlp], Settings(EXACT, "bipartite"))
        bounds = error_bounds(alone, mlp, EXACT, 3)
        # Bits are cut at other places than in a single network, which changes a result by a unit or
        # two.
        assert (off(design, mlp, slice(i, i + 1)) <= bounds + 2.0**-12).all()


def test_nodes_of_about_the_same_reach_share_their_tables() -> None:
    design = AdderGraph.of([random_mlp((2, 5, 1), 5.0, 1)], Settings(EXACT, "bipartite"))
    (groups,), (activations,) = design.groups, design.activations
    assert sorted(j for nodes in groups for j in nodes) == list(range(5))
    widths = [design.layers[0].result_widths[j] for nodes in groups for j in nodes]
    assert widths == sorted(widths)
    for nodes in groups:
        assert len({activations[j] for j in nodes}) == 1


def test_no_multiplier_and_a_frame_a_clock() -> None:
    design = load_scene("digit-fast").twin()
    assert design.interval == 1
    assert any("every multiplier" in text for text in left_out(design))


def test_each_cause_of_error_moves_an_output_by_what_it_can() -> None:
    mlp = random_mlp((3, 4, 2), 1.0, 4)
    design = AdderGraph.of([mlp], Settings(EXACT, "bipartite"))
    *others, (_, tabled), (_, cut_once), (_, cut) = stages(design, frames_of(3))
    ideal = np.clip(8192 * mlp.process(SIGNAL.to_real(frames_of(3)), tanh), *ENDS)
    # The bound is that of weights of 18 bits, and half a unit.
    assert np.abs(others[0][1] - ideal).max() < 1
    assert len({output.tobytes() for _, output in others}) == 2
    assert np.abs(tabled - others[1][1]).max() <= np.ceil(np.abs(mlp.w2).sum(axis=1)).max()
    assert (tabled != cut_once).any()
    outputs = design.layers[-1]
    units = [max(map(abs, ends)) / 2.0**outputs.out_shift for ends in outputs.errors]
    assert 0 < np.abs(cut - cut_once).max() <= 1 + max(units)
