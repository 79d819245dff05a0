"""Networks of learned functions, as layers and on engines."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import on_engine
from test_engine import random_codes

from golden.engine.graph import Kind
from golden.engine.integer_network import evaluate
from golden.input_error import InputError
from golden.networks.bounds import engine_bounds
from golden.networks.design import Settings
from golden.networks.engine import Engine
from golden.numbers.precision import SIGNAL
from golden.trained.dense import DenseNetwork
from golden.trained.function import Function
from golden.trained.function_network import Edge, FunctionNetwork
from golden.trained.spline_basis import Basis
from tactus.network_files.network_file import load_network, save_network
from tactus.report.draw.learned import nodes_of, scene_nodes
from tactus.report.draw.pictures import pictures
from tactus.report.draw.svg import ACCENT, Picture
from tactus.scene import load_scene
from tb.common.cases import random_learned

# One edge of each kind reaches every sum.
STRAIGHT, NONE = 0.25, None
WIDE = {"segment_width": 12}
FORMS = [{}, WIDE | {"pipeline": "deep"}]
FORMS.append({"reload": True, "segment_width": 11, "program_words": 2048})


def three_kinds() -> FunctionNetwork:
    """Three sums of three samples, with curved and straight edges, and some that are left out."""
    made = random_learned((3, 3, 2), 0, 1.0, 3)
    first = [list(edges) for edges in made.first]
    second = [list(edges) for edges in made.second]
    first[0][1], first[1][0], second[0][1] = NONE, STRAIGHT, NONE
    return replace(made, first=first, second=second)


def value(edge: Edge, x: np.ndarray) -> np.ndarray:
    """An edge by its definition."""
    if edge is None:
        return np.zeros_like(x)
    if isinstance(edge, float):
        return edge * x
    low, high, most, *coefficients = edge
    values, _ = Basis(low, high, len(coefficients) - 3).at(x)
    return np.clip(values @ np.array(coefficients), -most, most)


def by_definition(network: FunctionNetwork, x: np.ndarray) -> np.ndarray:
    sums = [sum(value(e, x[:, i]) for i, e in enumerate(row)) for row in network.first]
    outputs = [sum(value(e, sums[h]) for h, e in enumerate(row)) for row in network.second]
    return np.stack(outputs, axis=-1) + np.array(network.biases)


@pytest.mark.parametrize("network", [three_kinds(), random_learned((2, 2, 1), 0, 1.0, 5)])
def test_layers_are_what_the_sums_say(network: FunctionNetwork) -> None:
    x = random_codes(len(network.first[0]), 200) / 2.0**SIGNAL.frac
    assert np.allclose(network.layers().process(x), by_definition(network, x), atol=1e-12)


@pytest.mark.parametrize("options", FORMS, ids=str)
def test_every_engine_adds_functions_up(options: dict) -> None:
    """Each has the results of the whole numbers, and these are within the bound of the errors."""
    network = three_kinds().layers()
    engine = Engine.of([network], Settings(options=options))
    frames = random_codes(3, 200)
    found = engine.process(frames)
    assert np.array_equal(found, evaluate(engine.integers, frames))
    assert len(engine.integers[0].layers) == 2
    off = np.abs(found / 2.0**SIGNAL.frac - network.process(frames / 2.0**SIGNAL.frac))
    bounds = engine_bounds(network, engine.program.segment_width, 3)
    assert (off.max(axis=0) <= bounds).all()
    assert bounds.max() < 0.05


@pytest.mark.parametrize(
    ("large", "opposite", "looked_up", "products"),
    [
        # What is left of a rising function without a line is one small function.
        ((2.1, -2, -1.4, -0.4, 0.3, 1.3, 2), (2.1, 1.5, 0.9, 0.3, -0.3, -0.9, -1.5), 1, 1),
        # A function that falls and rises again is as large without any line.
        ((2.1, 2, 0.2, -1.5, -1.5, 0.2, 2), (2.1, -2, -0.3, 1.4, 1.5, -0.1, -2), 3, 0),
    ],
    ids=("a line and what is left", "in parts"),
)
def test_a_function_that_is_larger_than_a_word(
    large: tuple[float, ...], opposite: tuple[float, ...], looked_up: int, products: int
) -> None:
    """A small output is the difference of two functions that reach 2."""
    bent = (-1.0, 1.0, 1.0, 0.9, 0.2, -0.3, -0.3, 0.2, 0.9)
    both = [(-1.0, 1.0, *large), (-1.0, 1.0, *opposite)]
    network = FunctionNetwork([[bent], [bent]], [both], [0.0], [4.0, 4.0])
    engine = Engine.of([network.layers()], Settings(options=WIDE))
    assert len(engine.integers[0].layers) == 2
    terms = [term for neuron in engine.graph.neurons for term in neuron.terms]
    assert sum(term.kind is Kind.INTERCEPT for term in terms) == 2 + 2 * looked_up
    assert sum(term.kind is Kind.WORD for term in terms) == 2 * products
    frames = random_codes(1, 200)
    found = engine.process(frames)
    assert np.array_equal(found, evaluate(engine.integers, frames))
    real = by_definition(network, frames / 2.0**SIGNAL.frac)
    assert np.abs(found / 2.0**SIGNAL.frac - real).max() < 0.01


def test_a_later_network_takes_the_output_of_an_earlier_one() -> None:
    networks = [random_learned((2 + n, 2, 1), n, 1.0, n).layers() for n in range(3)]
    engine = Engine.of(networks, Settings(options={"segment_width": 10}), "cascade")
    frames = random_codes(2, 200)
    found = engine.process(frames)
    assert np.array_equal(found, evaluate(engine.integers, frames))
    assert [len(one.layers) for one in engine.integers] == [2, 2, 2]
    x = frames / 2.0**SIGNAL.frac
    for network in networks:
        x = np.concatenate([x, network.process(x)], axis=1)
    assert np.abs(found / 2.0**SIGNAL.frac - x[:, 2:]).max() < 4 / 2.0**SIGNAL.frac


def test_a_file_holds_the_functions(tmp_path: Path) -> None:
    network = three_kinds().layers()
    path = tmp_path / "network.npz"
    save_network(path, network, {"scene": "none"})
    read = load_network(path, network.shape)
    assert [layer.functions for layer in read.layers] == [one.functions for one in network.layers]
    x = random_codes(3, 200) / 2.0**SIGNAL.frac
    assert np.array_equal(read.process(x), network.process(x))


@pytest.mark.parametrize("spline", [(0.0,), (1.0, 0.0, *[1.0] * 5), (0.0, 1.0, 1.0, *[np.nan] * 4)])
def test_a_spline_that_is_none_is_refused(spline: tuple[float, ...]) -> None:
    with pytest.raises(InputError, match="got a spline of"):
        Function("bent", spline=spline)


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
    names, places = ["x0", "x1", "x2"], ["0", "1"]
    for inner, outer in nodes_of(model, inputs, names, places):
        for edge in outer:
            outputs[:, int(edge.of)] += edge.at(edge.x)
        # What is left is the constant of the sum.
        assert np.ptp(outer[0].x - sum(edge.at(edge.x) for edge in inner)) < 1e-12
    np.testing.assert_allclose(outputs, model.process(inputs), atol=1e-12)


@pytest.mark.parametrize("arrangement", ["single", "cascade"])
def test_the_picture_of_a_scene_has_every_function(tmp_path: Path, arrangement: str) -> None:
    single = arrangement == "single"
    one = FunctionNetwork([[BENT, 0.25, None]], [[STEEP]], [0.1], [2.0])
    two = FunctionNetwork([[BENT, None, 0.5, BENT]], [[STEEP]], [0.0], [1.0], 1)
    networks = [network()] if single else [one.layers(), two.layers()]
    keys = "segment_width = 11"
    path = on_engine(tmp_path, networks, arrangement=arrangement, hardware=keys)
    scene = load_scene(str(path))
    nodes = scene_nodes(scene)
    names = {
        name: [edge.of for side in first for edge in side] for name, (first, *_) in nodes.items()
    }
    assert names == (
        {"y0, y1": ["x0", "x1", "x2", "y0", "y1"]}
        if single
        else {"y0": ["x0", "x1", "x2", "y0"], "y1": ["x0", "x1", "x2", "y0", "y1"]}
    )
    edges = [edge for found in nodes.values() for node in found for side in node for edge in side]
    for edge in edges:
        assert (edge.form == "flat") == (not any(edge.values))
    drawn = next(
        one for one in pictures(scene) if isinstance(one, Picture) and one.name == "functions"
    )
    assert drawn.svg.count(f"stroke: {ACCENT}") == sum(edge.form == "curved" for edge in edges)
