"""Tests the program of the engine: what it computes, in which order, and how it is encoded."""

import re
from collections import Counter
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from conftest import on_engine, random_mlp, write_scene
from hypothesis import given, settings
from hypothesis import strategies as st

from golden.engine.formats import HIDDEN, SAMPLE, WIDTH, coeff_frac
from golden.engine.frame_check import FrameCheck
from golden.engine.graph import Graph, Kind, Neuron, Term
from golden.engine.integer_network import evaluate
from golden.engine.lane_groups import LaneGraph
from golden.engine.lane_program import LaneInstruction, LaneProgram
from golden.engine.neurons import graph_of
from golden.engine.pipeline import LanePipeline, Pipeline
from golden.engine.quantise import integer_networks
from golden.engine.schedule import Step, schedule
from golden.input_error import InputError
from golden.networks.design import Settings
from golden.networks.engine import Engine
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.trained.mlp import Mlp
from tactus.cli.listing import main
from tactus.scene import load_scene

PAGE = Path(__file__).parents[1] / "docs" / "instruction-set.md"
PIPELINES = [Pipeline(), Pipeline(memory_registers=1)]


def random_codes(inputs: int, count: int, seed: int = 1) -> Codes:
    """Random frames, with the rails among them."""
    codes = np.random.default_rng(seed).integers(SIGNAL.low, SIGNAL.high + 1, (count, inputs))
    codes[0], codes[1] = SIGNAL.low, SIGNAL.high
    return codes


SHAPES = st.tuples(st.integers(1, 4), st.integers(1, 6), st.integers(1, 3))


@st.composite
def networks(draw: st.DrawFn) -> tuple[str, list[Mlp]]:
    """One or several networks, with weights from small ones to some that need more than 18 bits."""
    arrangement = draw(st.sampled_from(["single", "multiple", "cascade"]))
    count = 1 if arrangement == "single" else draw(st.integers(2, 3))
    inputs, hidden, outputs = draw(SHAPES)
    spread = draw(st.sampled_from([0.1, 1.0, 10.0, 100.0]))
    mlps = []
    for n in range(count):
        earlier = n * outputs if arrangement == "cascade" else 0
        mlp = random_mlp((inputs + earlier, hidden, outputs), spread, draw(st.integers(0, 99)))
        if draw(st.booleans()):
            # This makes a node that no output uses, and a sensor that no node uses.
            mlp.w2[:, -1] = 0
            mlp.w1[:, 0] = 0
        mlps.append(mlp)
    return arrangement, mlps


@settings(max_examples=40)
@given(several=networks(), width=st.sampled_from([7, 8, 9]))
def test_networks_of_any_shape(several: tuple[str, list[Mlp]], width: int) -> None:
    arrangement, mlps = several
    codes = random_codes(mlps[0].shape[0], 50)
    expected = evaluate(integer_networks(arrangement, mlps, segment_width=width), codes)
    for lean in (True, False):
        settings = Settings(options={"segment_width": width}, lean=lean)
        engine = Engine.of(mlps, settings, arrangement)
        assert np.array_equal(engine.process(codes), expected)


@pytest.mark.parametrize("pipeline", PIPELINES, ids=str)
def test_lean_leaves_out_steps(pipeline: Pipeline) -> None:
    mlp = random_mlp((3, 4, 2), 1.0, 1)
    mlp.w2[:, -1] = 0
    mlp.w1[:, 0] = 0
    whole = integer_networks("single", [mlp])
    lean, full = (schedule(graph_of(whole, kind), pipeline) for kind in (True, False))
    # Of a node its bias, three samples and tanh; of three others a sample each; two weights.
    assert len(used(full)) - len(used(lean)) == (1 + 3 + 2) + 3 + 2


def used(steps: list[Step]) -> list[Step]:
    return [step for step in steps if step.neuron >= 0]


@st.composite
def graphs(draw: st.DrawFn) -> Graph:
    """Random neurons that read any earlier values, with sums of any length."""
    inputs = draw(st.integers(1, 4))
    neurons = []
    for n in range(draw(st.integers(1, 12))):
        terms = draw(
            st.lists(
                st.one_of(
                    st.builds(Term, st.just(Kind.ONE), st.just(-1), st.integers(-9, 9)),
                    st.builds(
                        Term,
                        st.sampled_from([Kind.WORD, Kind.INTERCEPT, Kind.DISTANCE]),
                        st.integers(0, inputs + n - 1),
                        st.integers(-(1 << (WIDTH - 1)), (1 << (WIDTH - 1)) - 1),
                    ),
                ),
                min_size=1,
                max_size=5,
            )
        )
        neurons.append(Neuron(f"n{n}", HIDDEN, tuple(terms), draw(st.booleans())))
    neurons[-1] = replace(neurons[-1], output=True)
    return Graph(inputs, tuple(neurons))


def places(steps: list[Step]) -> dict[int, list[int]]:
    """For each neuron the steps of its sum."""
    found: dict[int, list[int]] = {}
    for n, step in enumerate(steps):
        if step.neuron >= 0:
            found.setdefault(step.neuron, []).append(n)
    return found


@given(graph=graphs(), pipeline=st.sampled_from(PIPELINES))
def test_the_schedule_respects_hazards(graph: Graph, pipeline: Pipeline) -> None:
    steps = schedule(graph, pipeline)
    at = places(steps)
    assert at.keys() == set(range(len(graph.neurons)))
    for n, neuron in enumerate(graph.neurons):
        begin, end = at[n][0], at[n][-1]
        # Every term comes once, and no other sum comes between them, because there is one
        # accumulator.
        assert Counter(steps[k].term for k in at[n]) == Counter(neuron.terms)
        assert {steps[k].neuron for k in range(begin, end + 1)} <= {n, -1}
        assert [k for k in at[n] if steps[k].first] == [begin]
        assert [k for k in at[n] if steps[k].last] == [end]
        for k in at[n]:
            source = steps[k].term.source - graph.inputs
            if source >= 0:
                assert k >= at[source][-1] + pipeline.result_ready
    ends = [at[n][-1] for n, neuron in enumerate(graph.neurons) if neuron.output]
    assert ends == sorted(ends)


@pytest.mark.parametrize("registers", [0, 1])
def test_the_page_says_where_each_field_stands(registers: int) -> None:
    page, pipeline = PAGE.read_text(), LanePipeline(registers)
    names = [field.name for field in fields(LaneInstruction)]
    shared = LaneGraph(2, Graph(1, ()), (), ((0, 0),))
    for name in names:
        row = re.search(rf"^\| `{name}` \| (\d+)(?: to (\d+))? \| (?:`(\w+)`)? ?\|", page, re.M)
        assert row, name
        high, low = int(row[1]), int(row[2] or row[1])
        words = [0] * 40
        words[20] = (2 << high) - (1 << low)
        steps = LaneProgram(1, 9, (), tuple(words), pipeline, (), shared=shared).steps
        found = [n for n, step in enumerate(steps) if getattr(step, name)]
        assert found == [20 - (getattr(pipeline, row[3]) if row[3] else 0)], name
        others = [getattr(steps[found[0]], other) for other in names if other != name]
        assert not any(others), name
        assert getattr(steps[found[0]], name) == (2 << (high - low)) - 1, name


def test_a_large_weight_is_several_terms_of_the_same_sum() -> None:
    mlp = random_mlp((2, 1, 1), 1.0, 1)
    mlp.w1[0] = [100.0, -100.0]
    (hidden, *_) = graph_of(integer_networks("single", [mlp])).neurons
    most = 1 << (WIDTH - 1)
    for source, weight in ((0, 100), (1, -100)):
        parts = [term.weight for term in hidden.terms if term.source == source]
        assert len(parts) > 1
        assert all(-most < part < most for part in parts)
        assert sum(parts) == weight << coeff_frac(HIDDEN, SAMPLE)


def test_the_listing_names_every_step(tmp_path, capsys, monkeypatch) -> None:
    mlps = [random_mlp((2, 2, 1), 1.0, 3)]
    path = on_engine(tmp_path, mlps)
    monkeypatch.setattr("sys.argv", ["listing", str(path)])
    main()
    head, columns, *lines = capsys.readouterr().out.splitlines()
    engine = load_scene(str(path)).twin()
    steps = engine.program.steps
    assert head.startswith("tanh in 256 segments of 0.03125")
    names = columns.split()
    assert names == ["step", "neuron", "operand", "address", "weight", "then"]
    begin = [columns.index(name) for name in names]
    rows = [
        [line[a:b].strip() for a, b in zip(begin, [*begin[1:], None], strict=True)]
        for line in lines[: len(steps)]
    ]
    assert [row[0] for row in rows] == [str(n) for n in range(len(steps))]
    for row, step in zip(rows, steps, strict=True):
        if row[2].startswith("sample"):
            assert row[3] == str(step.source)
            (weight,) = engine.program.weights[step.place]
            frac = coeff_frac(HIDDEN, SAMPLE)
            assert float(row[4]) == pytest.approx(weight / (1 << frac), rel=1e-5)
    assert rows[-1][-1].endswith(f"leaves in clock {engine.output_clocks[-1]}")
    stored = [int(row[-1].split()[2].rstrip(",")) for row in rows if row[-1]]
    assert stored == list(range(engine.inputs, engine.program.addresses))


def test_a_scene_without_a_program_has_no_listing(tmp_path, monkeypatch) -> None:
    path = write_scene(tmp_path, "folded", "exact", [random_mlp((2, 2, 1), 1.0, 3)])
    monkeypatch.setattr("sys.argv", ["listing", str(path)])
    with pytest.raises(InputError, match=r"hardware\.design: got hybrid, which has no program"):
        main()


def test_what_does_not_fit_is_refused() -> None:
    with pytest.raises(InputError, match=r"frame_check: got inputs=8, expected 1 to 7"):
        FrameCheck(8, 3, 20, Pipeline())
    wide = random_mlp((1000, 12, 1), 1.0, 1)
    with pytest.raises(InputError, match=re.escape("got 1025 words of the operand memory")):
        Engine.of([wide])
