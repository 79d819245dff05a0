"""Activations that are tables: functions of a scene, their fit, and engines that look them up."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import on_engine
from hypothesis import given, settings
from hypothesis import strategies as st
from test_engine import random_codes

from golden.engine.formats import DROPPED, HIDDEN, RESULT
from golden.engine.function_table import codes_of, format_of, joined, table_of
from golden.engine.graph import Kind
from golden.engine.integer_network import evaluate
from golden.engine.memories import block_of
from golden.input_error import InputError
from golden.networks.design import Settings
from golden.networks.engine import Engine
from golden.networks.oracle import engine_bounds
from golden.numbers.precision import SIGNAL
from golden.trained.dense import Dense, DenseNetwork, network_of
from golden.trained.function import Function
from golden.trained.function_network import Edge, FunctionNetwork
from golden.trained.spline_basis import Basis
from tactus.network_files.network_file import load_network, save_network
from tactus.report.draw.learned import nodes_of, scene_nodes
from tactus.report.draw.svg import ACCENT
from tactus.report.page.content import pictures
from tactus.scene import load_scene
from tactus.scene.codes import saturating
from tb.common.cases import random_learned, random_network

CODES = np.arange(HIDDEN.low, HIDDEN.high + 1)
SOFTSIGN = Function("softsign", "x / (1 + abs(x))")
SIGMOID = Function("sigmoid", "1 / (1 + exp(-x))")
BELL = Function("gaussian", "exp(-x * x)")
WAVE = Function("sine", "sin(x)")
GELU = Function("gelu", "0.5 * x * (1 + erf(x / sqrt(2)))")
POINTS = Function("points", points=((-2.0, 0.5), (-0.25, -1.0), (1.5, 0.75)))
SHOWN = (SIGMOID, SOFTSIGN, BELL, WAVE, GELU)
EVERY = (*SHOWN, POINTS)


def network(
    shape: tuple[int, ...], kinds: tuple[str, ...], spread: float = 1.5, seed: int = 1
) -> DenseNetwork:
    return random_network(shape, kinds, spread, seed, functions=EVERY)


# The fit.


@pytest.mark.parametrize("function", EVERY, ids=lambda f: f.name)
def test_the_blocks_compute_the_function_with_the_published_error(function: Function) -> None:
    """Behind another function, over every code of q."""
    lines = joined((WAVE, function) if function != WAVE else (BELL, WAVE), 9)
    code = codes_of((WAVE, function) if function != WAVE else (BELL, WAVE))[function]
    segments = (np.where(CODES < 0, ~CODES, CODES) >> 9) & (lines.segments - 1)
    places = segments + block_of(code, CODES < 0) * lines.segments
    one, distance = np.where(CODES < 0, -1, 1) << DROPPED, (CODES & 511) - 256
    sums = np.array(lines.intercepts)[places] * one + np.array(lines.slopes)[places] * distance
    words = np.clip((sums + (1 << (DROPPED - 1))) >> DROPPED, RESULT.low, RESULT.high)
    off = format_of(function).to_real(words) - function.value(HIDDEN.to_real(CODES))
    assert np.abs(off).max() == table_of(function, 9).error


@given(
    st.lists(st.integers(-250, 250), min_size=2, max_size=6, unique=True),
    st.lists(st.integers(-(1 << 12), 1 << 12), min_size=6, max_size=6),
)
@settings(deadline=None, max_examples=10)
def test_corners_between_segments_are_exact(places: list[int], heights: list[int]) -> None:
    """A segment of 9 bits is 1/32 wide. The results of a line are rounded once."""
    points = zip(sorted(places), heights, strict=False)
    function = Function("corners", points=tuple((x / 32, y / 4096) for x, y in points))
    table = table_of(function, 9)
    # A result and an intercept are rounded by half a unit, and a slope by a 128th of one at most.
    assert table.error <= 1.01 * 2.0**-table.result.frac


# On the engine.


@pytest.mark.parametrize("function", EVERY, ids=lambda f: f.name)
def test_the_engine_is_as_near_to_real_arithmetic_as_its_table(function: Function) -> None:
    dense = network((2, 4, 1), (f"table:{function.name}",))
    engine = Engine.of([dense], Settings())
    codes = random_codes(2, 200)
    real = np.clip(dense.process(SIGNAL.to_real(codes)), -1, SIGNAL.to_real(SIGNAL.high))
    off = np.abs(SIGNAL.to_real(engine.process(codes)) - real).max(axis=0)
    assert (off <= engine_bounds(dense, engine.program.segment_width, 2)).all()


def test_tables_that_take_too_much_memory_are_refused() -> None:
    """Nine functions with two blocks of 1024 words each."""
    functions = tuple(Function(f"f{n}", f"exp(-x * x) * 0.{n}") for n in range(1, 10))
    first = Dense(np.full((9, 1), 20.0), np.zeros(9), "table:f1 to f9", functions=functions)
    dense = network_of([first, Dense(np.ones((1, 9)), np.zeros(1))])
    with pytest.raises(InputError, match="functions: got 18432 words, 1024 for each of 18 bl"):
        Engine.of([dense], Settings(options={"segment_width": 7}))
    Engine.of([dense], Settings(options={"segment_width": 8}))


# In images.


def reloadable(kind: str, **sizes: int) -> Engine:
    options = {"reload": True, "program_words": 2048, **sizes}
    return Engine.of([network((2, 3, 1), (kind,))], Settings(options=options))


HARDWARE = {
    # Three blocks, one block, and room for four in hardware whose own network has tanh alone.
    "table:softsign,gaussian,sine": {},
    "table:softsign": {},
    "tanh": {"table_blocks": 4},
}


@pytest.mark.parametrize("kind", HARDWARE)
def test_images_bring_functions_of_their_own(kind: str) -> None:
    """Images with other functions, tanh or none run on hardware with blocks enough for them."""
    hardware = reloadable(kind, **HARDWARE[kind])
    blocks = hardware.loaded.sizes.blocks if HARDWARE[kind] or kind != "tanh" else 0
    for other, needed in (
        ("table:softsign,gaussian,sine,sine", 4),
        ("table:gelu", 2),
        ("table:sine,softsign,sine,sine", 2),
        ("table:points,gaussian,sine,sine", 5),
        ("tanh", 1),
        ("linear", 1),
    ):
        if needed > blocks:
            with pytest.raises(InputError, match=rf"{needed} table_blocks for .+, there are "):
                hardware.image_for([network((4, 4, 2), (other,))])
            continue
        dense = network((4, 4, 2), (other,))
        image = hardware.image_for([dense])
        running = hardware.running(hardware.received(image.to_bytes()))
        codes = random_codes(4, 50)
        assert np.array_equal(running.process(codes), Engine.of([dense]).process(codes))
        assert running.parts() == hardware.parts()


# In files and scenes.


def keys(*functions: Function) -> list[tuple[str, str]]:
    return [(function.name, function.expression) for function in functions]


def scene_of(folder: Path, kinds: str = '["table:softsign"]') -> Path:
    path = on_engine(
        folder, [network((2, 3, 1), ("table:softsign",))], functions=keys(SOFTSIGN, BELL)
    )
    path.write_text(path.read_text().replace("hidden = 3", f"hidden = 3\nactivations = {kinds}"))
    return path


def test_a_scene_defines_what_its_network_names(tmp_path: Path) -> None:
    scene = load_scene(str(scene_of(tmp_path)))
    codes = random_codes(2, 50)
    engine = Engine.of([network((2, 3, 1), ("table:softsign",))], Settings())
    assert np.array_equal(scene.twin().process(codes), engine.process(codes))
    (read,) = scene.networks()
    assert np.array_equal(
        read.process(SIGNAL.to_real(codes)), scene.process_real(SIGNAL.to_real(codes))
    )


@pytest.mark.parametrize(
    "points", ["{ x = [-1, 0, 2], y = [0.5, 1.25, 0] }", '{ points = "valve.csv" }']
)
def test_points_are_read(tmp_path: Path, points: str) -> None:
    path = scene_of(tmp_path, '["table:bell,bell,softsign"]')
    (tmp_path / "valve.csv").write_text("x,y,why\n-1,0.5,1\n0,1.25,1\n2,0,1\n")
    path.write_text(re.sub(r"gaussian = .*", f"bell = {points}", path.read_text()))
    scene = load_scene(str(path))
    (member,) = scene.members
    assert [function.name for function in member.functions] == ["softsign", "bell"]
    assert member.functions[1].points == ((-1, 0.5), (0, 1.25), (2, 0))
    assert member.functions[1].value(np.array([-3.0, 1.0, 5.0])).tolist() == [0.5, 0.625, 0]
    assert (tmp_path / "valve.csv" in scene.files) == ("valve" in points)


@pytest.mark.parametrize(("function", "reach"), [(GELU, 20.0), (BELL, None), (POINTS, None)])
def test_sums_beyond_a_table_are_named(tmp_path: Path, function: Function, reach) -> None:
    """A function that is level there loses nothing."""
    first = Dense(
        np.array([[0.0, 0.0], [1.0, 1.0]]),
        np.array([20.0, 0.0]),
        f"table:{function.name}",
        functions=(function,) * 2,
    )
    dense = network_of([first, Dense(np.array([[0.01, 0.1]]), np.zeros(1))])
    path = on_engine(tmp_path, [dense], functions=keys(GELU, BELL))
    text = path.read_text()
    points = (
        f"points = {{ x = {[x for x, _ in POINTS.points]}, y = {[y for _, y in POINTS.points]} }}"
    )
    path.write_text(text.replace("[network.functions]", f"[network.functions]\n{points}"))
    expected = "mine.npz: layer 1: sums reach 20 in 12 of 12 recorded frames; beyond -8 and 8 gelu"
    assert saturating(load_scene(str(path))) == ([f"{expected} keeps its value"] if reach else [])


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


def two_sums() -> DenseNetwork:
    """Two hidden sums of three inputs, and two outputs; one edge of each kind is there."""
    first = [[BENT, 0.25, None], [None, BENT, -0.5]]
    second = [[STEEP, 0.5], [None, STEEP]]
    return FunctionNetwork(first, second, [0.1, -0.05], [2.0, 2.0], 0, [0.05, 0.0]).layers()


def test_sums_and_outputs_are_those_of_the_network() -> None:
    model = two_sums()
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
    networks = [two_sums()] if single else [one.layers(), two.layers()]
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
    drawn = next(one for one in pictures(scene) if one.name == "functions")
    assert drawn.svg.count(f"stroke: {ACCENT}") == sum(edge.form == "curved" for edge in edges)
