"""Tests how the functions of a network of learned functions are found in its layers, and drawn."""

from pathlib import Path

import numpy as np
import pytest

from golden.trained.dense import DenseNetwork
from golden.trained.function_network import Edge, FunctionNetwork
from tactus.report.draw.pictures import pictures
from tactus.report.draw.titled_picture import Picture
from tactus.report.measure.learned_edges import (
    BINS,
    INPUT,
    SUM,
    VALUES,
    nodes_of,
    scene_edges,
)
from tactus.scene import load_scene
from tactus.verify.benches.written import write_scene

BENT: Edge = (-1.0, 1.0, 0.9, 0.3, -0.2, 0.1, 0.5)
STEEP: Edge = (-3.0, 3.0, 0.6, -0.3, -0.2, 0.1, 0.3)


def network(earlier: int = 0) -> DenseNetwork:
    """Two hidden sums of three inputs, and two outputs; one edge of each kind is there."""
    first = [[BENT, 0.25, None], [None, BENT, -0.5]]
    second = [[STEEP, 0.5], [None, STEEP]]
    return FunctionNetwork(first, second, [0.1, -0.05], [2.0, 2.0], earlier, [0.05, 0.0]).layers()


def test_sums_and_outputs_are_those_of_the_network() -> None:
    model = network()
    inputs = np.random.default_rng(1).uniform(-1, 1, (50, 3))
    outputs = np.tile(model.layers[-1].biases, (50, 1))
    for found in nodes_of(model, inputs):
        outer = [(place, edge.at(s)) for side, place, edge, s in found if side == SUM and edge]
        for place, values in outer:
            outputs[:, place] += values
        inner = sum(edge.at(x) for side, _, edge, x in found if side == INPUT and edge)
        sums = next(s for side, _, _, s in found if side == SUM)
        # What is left is the constant of the sum.
        assert np.ptp(sums - inner) < 1e-12
    np.testing.assert_allclose(outputs, model.process(inputs), atol=1e-12)


@pytest.mark.parametrize("arrangement", ["single", "cascade"])
def test_the_picture_of_a_scene_has_every_function(tmp_path: Path, arrangement: str) -> None:
    single = arrangement == "single"
    one = FunctionNetwork([[BENT, 0.25, None]], [[STEEP]], [0.1], [2.0])
    two = FunctionNetwork([[BENT, None, 0.5, BENT]], [[STEEP]], [0.0], [1.0], 1)
    path = write_scene(
        tmp_path,
        "bent",
        "exact",
        [network()] if single else [one.layers(), two.layers()],
        arrangement,
        activation="precise",
        design="engine",
        hardware="segment_width = 11",
    )
    scene = load_scene(str(path))
    table = scene_edges(scene)
    assert table is not None
    names = {
        row[0]: [r[3] for r in table.rows if r[0] == row[0] and r[1] == 1] for row in table.rows
    }
    assert names == (
        {"y0, y1": ["x0", "x1", "x2", "y0", "y1"]}
        if single
        else {"y0": ["x0", "x1", "x2", "y0"], "y1": ["x0", "x1", "x2", "y0", "y1"]}
    )
    for row in table.rows:
        assert sum(float(str(cell)) for cell in row[-BINS:]) == pytest.approx(1)
        assert (row[4] == "flat") == (not any(row[VALUES:-BINS]))
    drawn = next(
        one for one in pictures(scene) if isinstance(one, Picture) and one.name == "functions"
    )
    assert drawn.svg.count("curved</title>") == sum(row[4] == "curved" for row in table.rows)
