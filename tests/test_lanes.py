"""Tests the program of an engine with several multipliers: its results, its steps, its words."""

from collections import Counter
from dataclasses import fields, replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from myhdl import Simulation, delay, instance
from test_engine import networks, random_codes

from golden.engine.formats import WIDTH
from golden.engine.function_table import codes_of
from golden.engine.graph import LOOKED_UP, Graph, Kind
from golden.engine.integer_network import evaluate
from golden.engine.lane_groups import CHAIN, LaneGraph, reduction_steps
from golden.engine.lane_program import LaneInstruction, LaneProgram
from golden.engine.pipeline import LanePipeline
from golden.input_error import InputError
from golden.networks.design import Settings
from golden.networks.engine import Engine
from golden.networks.left_out import left_out
from golden.numbers.precision import SIGNAL
from golden.trained.dense import Dense, Quantiser, network_of
from golden.trained.function import TANH, Function
from hdl.common.lookup import hardware
from tactus.cli.listing import critical_path, main
from tactus.export.hierarchy import port_signals
from tactus.scene import load_scene
from tactus.verify.benches.written import scene_of
from tb.common.case_library import ENGINES, LANES, LAYERED, TABLES

# Clocks from frame to frame, and the lanes that are built.
SHIPPED = {
    "digit": (236, 1),
    "comparison/digit-lanes2": (153, 2),
    "comparison/digit-lanes4": (130, 4),
    "comparison/digits-lanes8": (397, 8),
}
# Several hidden layers. Two are quantised, and the last ones have functions of a user.
DEEP = (
    *("layers-engine", "steep-engine", "ranged-engine", "exact-engine", "floor-engine"),
    *("tables-engine", "deep-tables-engine"),
)


def lanes_of(
    name: str, lanes: int, lean: bool = True, pipeline: str = "short"
) -> tuple[Engine, Engine]:
    """A case of the benches of the engine with several multipliers and with one."""
    case = (ENGINES | LAYERED | TABLES)[name]
    found = case.networks()
    options = {"lanes": lanes, "pipeline": pipeline}
    many = Engine.of(found, Settings(options=options, lean=lean), case.arrangement)
    return many, Engine.of(found, Settings(lean=lean), case.arrangement)


@pytest.mark.parametrize("name", SHIPPED)
def test_a_scene_has_the_results_of_one_multiplier(name: str) -> None:
    scene = load_scene(name)
    many, one = scene.twin(), replace(scene, design="engine", design_options={}).twin()
    assert (many.interval, many.lanes) == SHIPPED[name]
    codes = np.concatenate([scene.vectors().codes[:200], random_codes(many.inputs, 200)])
    assert np.array_equal(many.process(codes), one.process(codes))
    assert many.interval < one.interval or many.lanes == 1


@settings(max_examples=40)
@given(several=networks(), lanes=st.integers(1, 16), lean=st.booleans())
def test_networks_of_any_shape(several: tuple, lanes: int, lean: bool) -> None:
    arrangement, mlps = several
    codes = random_codes(mlps[0].shape[0], 50)
    one = Engine.of(mlps, Settings(lean=lean), arrangement)
    many = Engine.of(mlps, Settings(options={"lanes": lanes}, lean=lean), arrangement)
    assert np.array_equal(many.process(codes), one.process(codes))


@pytest.mark.parametrize("lanes", [2, 3, 8])
@pytest.mark.parametrize("name", DEEP)
def test_networks_of_several_layers(name: str, lanes: int) -> None:
    for lean in (True, False):
        many, one = lanes_of(name, lanes, lean)
        codes = random_codes(one.inputs, 100)
        assert np.array_equal(many.process(codes), one.process(codes))
        found, expected = many.saturations(codes), one.saturations(codes)
        assert found.keys() == expected.keys()
        assert all(np.array_equal(found[layer], expected[layer]) for layer in found)


def test_sums_of_lanes_are_added_once() -> None:
    for lanes in range(1, 17):
        sums = [{lane} for lane in range(lanes)]
        for pairs in reduction_steps(lanes):
            before = [set(one) for one in sums]
            for lane, other in pairs:
                assert not before[lane] & before[other]
                sums[lane] |= before[other]
        assert sums[0] == set(range(lanes))
        adding = [lane for pairs in reduction_steps(lanes) for lane, _ in pairs]
        assert lanes > CHAIN or len(set(adding)) == len(adding)


@pytest.mark.parametrize("pipeline", ["short", "deep"])
@pytest.mark.parametrize("lanes", [2, 3, 8])
@pytest.mark.parametrize("name", ["chain-engine", "three-engine", "huge-engine", "layers-engine"])
def test_no_operand_is_read_before_it_is_stored_in_its_lane(
    name: str, lanes: int, pipeline: str
) -> None:
    """Every term is computed once: by the lane that holds its operand, or by one lane of those."""
    many, _ = lanes_of(name, lanes, pipeline=pipeline)
    program, shared = many.program, many.program.shared
    assert shared is not None
    steps = program.scheduled
    at = {step.neuron: n for n, step in enumerate(steps) if step.last}
    products = []
    for n, (step, code) in enumerate(zip(steps, program.steps, strict=True)):
        source = step.term.source - many.inputs
        if step.neuron >= 0 and source >= 0 and not code.gather:
            assert n >= at[source] + program.pipeline.result_ready
        if step.neuron >= 0:
            products.append(program.weights[code.place])
    terms = [t for neuron in many.graph.neurons for t in neuron.terms if t.weight]
    alike = sum(
        len([t for t in shared.graph.neurons[n].terms if any(shared.weights[t.weight])])
        * (len(shared.weights[0]) - 1)
        for n, group in enumerate(shared.groups)
        if group.alike
    )
    assert sum(weight != 0 for row in products for weight in row) == len(terms) + alike


def test_the_program_holds_what_was_scheduled() -> None:
    many, _ = lanes_of("rails-engine", 3)
    program = many.program
    address = {k: k for k in range(many.inputs)}
    for n, (step, code) in enumerate(zip(program.scheduled, program.steps, strict=True)):
        assert code.kind == step.term.kind
        assert bool(code.opens) == step.first
        assert bool(code.store) == step.last
        assert code.end == (n == program.length - 1)
        if step.term.source >= 0:
            assert code.source == address[step.term.source]
        if step.last:
            address[many.inputs + step.neuron] = len(address)
    assert len(address) == program.addresses
    assert program.words[-program.pipeline.padding :] == (0,) * program.pipeline.padding


def test_a_word_has_a_place_for_each_field() -> None:
    """Fields do not overlap: each bit of a word alone changes one field of one step."""
    pipeline, seen = LanePipeline(), set()
    shared = LaneGraph(1, Graph(1, ()), (), ((0,),))
    for bit in range(36):
        words = [0] * 40
        words[20] = 1 << bit
        program = LaneProgram(1, 9, (), tuple(words), pipeline, (), shared=shared)
        steps = program.steps
        named = [
            (n, field.name)
            for n, step in enumerate(steps)
            for field in fields(LaneInstruction)
            if getattr(step, field.name)
        ]
        assert len(named) == 1, bit
        seen.add(named[0][1])
    assert seen == {field.name for field in fields(LaneInstruction)}


def in_myhdl(design: Engine, frames: np.ndarray) -> np.ndarray:
    """The results of MyHDL itself, which checks the bounds of every signal."""
    ports = port_signals(design)
    clk, rst, samples, results = (ports[name] for name in ("clk", "rst", "in_", "out"))
    clocks = [None]
    for frame in frames:
        ends = [*enumerate(frame.tolist(), 1 - len(frame))]
        clocks += [*ends, *[None] * (design.interval - len(frame))]
    seen = []

    @instance
    def drive():
        for t, clock in enumerate([*clocks, *[None] * design.output_clocks[-1]]):
            rst.next, samples.valid.next = t == 0, clock is not None
            if clock:
                samples.last.next, samples.data.next = clock[0] == 0, clock[1]
            yield delay(1)
            if t and results.valid:
                seen.append(int(results.data))
            clk.next = True
            yield delay(1)
            clk.next = False

    Simulation(drive, hardware(design)(**ports, spec=design)).run(quiet=1)
    return np.reshape(seen, (len(frames), design.outputs))


@pytest.mark.parametrize("lanes", [1, 2])
def test_codes_of_one_bit(lanes: int) -> None:
    """A code has no bit above its lowest one, which is 0 half way between two codes."""
    weights = np.array([[1.0, 0.0], [0.5, 0.5], [1.0, 1.0]])
    hidden = Dense(weights, np.zeros(3), "relu", quantiser=Quantiser(1.0, 0, 0, 1))
    outputs = Dense(np.array([[0.5, 0.25, 0.125]]), np.zeros(1))
    twin = Engine.of([network_of([hidden, outputs])], Settings(options={"lanes": lanes}))
    assert twin.graph.cut == WIDTH - 2
    samples = np.array([[0.5, 0.0], [0.5, 0.5], [0.75, 0.0], [0.75, 0.75], [-0.5, 0.75]])
    codes, _ = SIGNAL.quantise(samples)
    # The sums of the first frame are 0.5, 0.25 and 0.5, and those of the second 0.5, 0.5 and 1.
    expected, _ = SIGNAL.quantise(np.array([[0.0], [0.125], [0.625], [0.875], [0.0]]))
    assert np.array_equal(evaluate(twin.integers, codes), expected)
    assert np.array_equal(in_myhdl(twin, codes), expected)


def test_no_more_lanes_than_a_layer_has_nodes() -> None:
    many, _ = lanes_of("least-engine", 16)
    assert many.lanes == 1
    assert "15 lanes that no layer has a node for" in left_out(many)


@pytest.mark.parametrize("name", SHIPPED)
def test_no_schedule_is_faster_than_its_path(name: str) -> None:
    many = load_scene(name).twin()
    shared = many.program.shared
    clock, names = critical_path(shared, many.program.pipeline)
    assert many.inputs < clock <= many.output_clocks[-1]
    numbers = [[neuron.name for neuron in shared.graph.neurons].index(one) for one in names]
    for before, after in pairwise(numbers):
        sources = [term.source for term in shared.graph.neurons[after].terms]
        assert many.inputs + before in sources


def test_the_listing_names_every_step(capsys, monkeypatch) -> None:
    monkeypatch.setattr("sys.argv", ["listing", "comparison/digit-lanes4"])
    main()
    many = load_scene("comparison/digit-lanes4").twin()
    head, columns, *lines = capsys.readouterr().out.splitlines()
    assert head.startswith("tanh in 256 segments")
    assert columns.split()[:4] == ["step", "neurons", "operand", "address"]
    assert [line.split()[0] for line in lines[: many.program.length]] == [
        str(n) for n in range(many.program.length)
    ]
    assert lines[many.program.length - 1].endswith(f"leaves in clock {many.output_clocks[-1]}")


@pytest.mark.parametrize("name", ["tables-lanes", "bell-lanes"])
def test_lanes_look_up_one_function_at_a_time(tmp_path, name: str) -> None:
    """A step names one function, so the nodes of a group have the same, and it is the one named."""
    many = scene_of(LANES[name], tmp_path, name).twin()
    program, neurons = many.program, many.graph.neurons
    found = Counter[Function]()
    for step, code in zip(program.scheduled, program.steps, strict=True):
        if step.neuron >= 0 and code.kind in LOOKED_UP:
            members = [n for n in program.shared.groups[step.neuron].members if n >= 0]
            (function,) = {neurons[n].function for n in members}
            assert code.place == codes_of(many.graph.functions)[function]
            found[function] += code.kind == Kind.DISTANCE
    # The nodes of a function are in as few groups as there can be; a tanh of all lanes is alone.
    nodes = Counter(n.function for n in neurons if n.looks_up)
    assert found == {
        function: count if function == TANH else -(-count // many.lanes)
        for function, count in nodes.items()
    }


def test_a_scene_with_too_many_weights_is_refused() -> None:
    wide = replace(LANES["least-lanes"], shapes=[(900, 20, 1)]).networks()
    with pytest.raises(InputError, match="got 8998 weights of each lane, expected 8192 at most"):
        Engine.of(wide, Settings(options={"lanes": 2}))
