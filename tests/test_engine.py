"""The engine: its program, its results beside the network in whole numbers, ranges and bounds."""

import csv
import re
from collections import Counter
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from conftest import random_mlp
from hypothesis import given, settings
from hypothesis import strategies as st
from refused import call
from shared import in_myhdl

from golden.engine.formats import DROPPED, HIDDEN, OUTPUT_SHIFT, SAMPLE, WIDTH, coeff_frac
from golden.engine.frame_check import FrameCheck
from golden.engine.function_table import codes_of
from golden.engine.graph import LOOKED_UP, Graph, Kind
from golden.engine.integer_network import LayerRounding, evaluate, sample_words
from golden.engine.lane_groups import LaneGraph
from golden.engine.lane_program import FIELDS, LaneProgram
from golden.engine.neurons import graph_of
from golden.engine.pipeline import Pipeline
from golden.engine.quantise import integer_networks
from golden.engine.ranges import ENOUGH, MARGIN, frac_of, hidden_peaks
from golden.input_error import InputError
from golden.networks.design import Settings
from golden.networks.engine import Engine
from golden.networks.oracle import engine_bounds, exact
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.trained.dense import ACTIVATIONS, Dense, DenseNetwork, Quantiser, network_of
from golden.trained.function import TANH, Function
from tactus.cli.listing import critical_path
from tactus.core.finding import OK, WARNING
from tactus.report.page.summary import built
from tactus.rig.check import everything
from tactus.scene import Scene, load_scene
from tactus.scene.codes import range_lines, saturating
from tactus.verify.benches.written import scene_of, write_scene
from tb.common.case_library import CASE
from tb.common.cases import random_network

PAGE = Path(__file__).parents[1] / "docs" / "instruction-set.md"


def random_codes(inputs: int, count: int, seed: int = 1) -> Codes:
    """Random frames, with the rails among them."""
    codes = np.random.default_rng(seed).integers(SIGNAL.low, SIGNAL.high + 1, (count, inputs))
    codes[0], codes[1] = SIGNAL.low, SIGNAL.high
    return codes


@pytest.mark.parametrize("registers", [0, 1])
def test_the_page_says_where_each_field_stands(registers: int) -> None:
    page, pipeline = PAGE.read_text(), Pipeline(registers)
    names = list(FIELDS)
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


@pytest.mark.parametrize("name", ["digit", "comparison/digit-lanes4"])
def test_the_listing_names_every_step(name: str, capsys) -> None:
    call("listing", name)
    head, columns, *lines = capsys.readouterr().out.splitlines()
    engine = load_scene(name).twin()
    steps, several = engine.program.steps, engine.lanes > 1
    assert head.startswith("tanh in 256 segments of 0.03125")
    names = re.split(" {2,}", columns)
    weights = ["weight of each lane" if several else "weight", "then"]
    assert names == ["step", f"neuron{'s' * several}", "operand", "address", *weights]
    begin = [columns.index(name) for name in names]
    rows = [
        [line[a:b].strip() for a, b in zip(begin, [*begin[1:], None], strict=True)]
        for line in lines[: len(steps)]
    ]
    assert [row[0] for row in rows] == [str(n) for n in range(len(steps))]
    for row, step in zip(rows, steps, strict=True):
        if row[2].startswith("sample"):
            assert row[3] == str(step.source)
            codes = [
                weight / 2 ** coeff_frac(HIDDEN, SAMPLE)
                for weight in engine.program.weights[step.place]
            ]
            assert [float(text) for text in row[4].split()] == pytest.approx(codes, rel=1e-5)
    assert rows[-1][-1].endswith(f"leaves in clock {engine.output_clocks[-1]}")
    stored = [int(re.split("[ ,]", row[-1])[2]) for row in rows if row[-1]]
    assert stored == list(range(engine.inputs, engine.program.addresses))


def test_what_does_not_fit_is_refused() -> None:
    with pytest.raises(InputError, match=r"frame_check: got inputs=8, expected 1 to 7"):
        FrameCheck(8, 3, 20, Pipeline())
    wide = random_mlp((1000, 12, 1), 1.0, 1)
    with pytest.raises(InputError, match=re.escape("got 1025 words of the operand memory")):
        Engine.of([wide])


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
    rows = [[1, 0, 0, 0]]
    for frame in codes.tolist():
        rows += [[0, 1, code, n == len(frame) - 1] for n, code in enumerate(frame)]
        rows += [[0, 0, 0, 0]] * twin.interval
    valid, data = in_myhdl(
        twin, ("rst", "in_valid", "in_data", "in_last"), ("out_valid", "out_data"), rows
    ).T
    assert np.array_equal(data[valid == 1].reshape(expected.shape), expected)


def test_no_more_lanes_than_a_layer_has_nodes() -> None:
    many = Engine.of(CASE["least-engine"].networks(), Settings(options={"lanes": 16}))
    assert many.lanes == 1
    assert "15 lanes that no layer has a node for" in many.left_out()


@pytest.mark.parametrize("name", ["digit", "comparison/digit-lanes4", "comparison/digits-lanes8"])
def test_no_schedule_is_faster_than_its_path(name: str) -> None:
    many = load_scene(name).twin()
    shared = many.program.shared
    clock, names = critical_path(shared, many.program.pipeline)
    assert many.inputs < clock <= many.output_clocks[-1]
    numbers = [[neuron.name for neuron in shared.graph.neurons].index(one) for one in names]
    for before, after in pairwise(numbers):
        sources = [term.source for term in shared.graph.neurons[after].terms]
        assert many.inputs + before in sources


@pytest.mark.parametrize("name", ["tables-lanes", "bell-lanes"])
def test_lanes_look_up_one_function_at_a_time(tmp_path, name: str) -> None:
    """A step names one function, so the nodes of a group have the same, and it is the one named."""
    many = scene_of(CASE[name], tmp_path, name).twin()
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
    wide = replace(CASE["least-lanes"], shapes=[(900, 20, 1)]).networks()
    with pytest.raises(InputError, match="got 8998 weights of each lane, expected 8192 at most"):
        Engine.of(wide, Settings(options={"lanes": 2}))


TABLES = (Function("softsign", "x / (1 + abs(x))"), Function("bell", "exp(-x * x)"))
KINDS = [*ACTIVATIONS, *(f"table:{function.name}" for function in TABLES)]


def frames_of(inputs: int, count: int = 40) -> Codes:
    """Random frames, coarse ones whose sums are half way between codes, and rails."""
    rng = np.random.default_rng(1)
    fine = rng.integers(SIGNAL.low, SIGNAL.high + 1, (count, inputs))
    coarse = rng.integers(-16, 16, (count, inputs)) << 9
    rails = rng.choice([SIGNAL.low, 0, SIGNAL.high], (20, inputs))
    return np.concatenate([fine, coarse, rails])


@st.composite
def networks(draw: st.DrawFn) -> tuple[str, list[DenseNetwork]]:
    """One or several networks, with weights from small ones to some that need more than 18 bits."""
    arrangement = draw(st.sampled_from(["single", "multiple", "cascade"]))
    count = 1 if arrangement == "single" else draw(st.integers(2, 3))
    inputs, outputs = draw(st.integers(1, 4)), draw(st.integers(1, 3))
    found = []
    for n in range(count):
        kinds = draw(st.lists(st.sampled_from(KINDS), min_size=1, max_size=3))
        hidden = [draw(st.integers(1, 6)) for _ in kinds]
        shape = (inputs + n * outputs * (arrangement == "cascade"), *hidden, outputs)
        spread = draw(st.sampled_from([0.1, 1.0, 10.0, 100.0][: 4 if kinds == ["tanh"] else 3]))
        seed = draw(st.integers(0, 99))
        made = random_network(shape, tuple(kinds), spread, seed, functions=TABLES)
        if made.plain and draw(st.booleans()):
            # This makes a node that no output uses, and a sensor that no node uses.
            made.layers[1].weights[:, -1] = made.layers[0].weights[:, 0] = 0
        found.append(made)
    return arrangement, found


@st.composite
def quantised(draw: st.DrawFn) -> tuple[str, list[DenseNetwork]]:
    """A network with a quantiser behind each hidden layer, in each rounding that there is."""
    kinds = draw(st.lists(st.sampled_from(["relu", "linear"]), min_size=1, max_size=3))
    bits = draw(st.integers(2, 8))
    low = draw(st.sampled_from([0, -1 << (bits - 1)])) if set(kinds) == {"linear"} else 0
    rounding = draw(st.sampled_from(["even", "floor"] if low else ["even", "floor", "away"]))
    scale = 2.0 ** -draw(st.integers(bits - 2, bits + 1))
    quantiser = Quantiser(scale, 0, low, low + (1 << bits) - 1, rounding)
    shape = tuple(draw(st.integers(1, 5)) for _ in range(len(kinds) + 2))
    return "single", [random_network(shape, tuple(kinds), 1.0, draw(st.integers(0, 99)), quantiser)]


def check_order(engine: Engine) -> None:
    """Every step reads a word that was stored before, though results come clocks later."""
    program = engine.program
    stored: dict[int, int] = {}
    for n, (step, code) in enumerate(zip(program.scheduled, program.steps, strict=True)):
        source = step.term.source - engine.inputs
        if step.neuron >= 0 and source >= 0 and not code.gather:
            assert n >= stored[source] + program.pipeline.result_ready
        if step.last:
            stored[step.neuron] = n


@settings(max_examples=100)
@given(
    several=st.one_of(networks(), quantised()),
    width=st.sampled_from([7, 8, 9]),
    lanes=st.integers(1, 16),
    pipeline=st.sampled_from(["short", "deep"]),
    lean=st.booleans(),
)
def test_every_engine_computes_the_networks_in_whole_numbers(
    several: tuple[str, list[DenseNetwork]], width: int, lanes: int, pipeline: str, lean: bool
) -> None:
    arrangement, found = several
    frames = frames_of(found[0].shape[0])
    expected = evaluate(integer_networks(arrangement, found, segment_width=width), frames)
    saturated = []
    for options in ({}, {"lanes": lanes, "pipeline": pipeline}):
        given = Settings(options={"segment_width": width, **options}, lean=lean)
        engine = Engine.of(found, given, arrangement)
        assert np.array_equal(engine.process(frames), expected)
        check_order(engine)
        saturated.append(engine.saturations(frames))
    np.testing.assert_equal(*saturated)


def test_a_quantised_network_does_not_see_the_half_unit_of_an_earlier_output() -> None:
    """It rounds the value itself, though a half is added to the word that it takes."""
    first = random_network((2, 3, 1), ("tanh",), 0.5, 1)
    behind = Quantiser(2.0**-SIGNAL.frac, 0, SIGNAL.low, SIGNAL.high, "even")
    second = network_of(
        [
            Dense(np.array([[0.0, 0.0, 1.0]]), np.zeros(1), "linear", quantiser=behind),
            Dense(np.array([[1.0]]), np.zeros(1)),
        ]
    )
    whole, frames = integer_networks("cascade", [first, second]), frames_of(2)
    *_, (_, words) = whole[0].run(sample_words(frames))
    half = 1 << (OUTPUT_SHIFT - 1)
    expected = np.rint((words - half) / (1 << OUTPUT_SHIFT))
    found = evaluate(whole, frames)
    assert np.array_equal(found[:, 1:], expected)
    assert (words % (1 << OUTPUT_SHIFT) > half).any()
    engine = Engine.of([first, second], arrangement="cascade")
    assert np.array_equal(engine.process(frames), found)


def test_the_codes_of_a_quantiser_are_those_of_its_file() -> None:
    """Worked by hand: codes count from the lowest one, and a tie goes to the even one."""
    quantiser = Quantiser(0.25, 2, 0, 7, "even")
    layers = [
        Dense(np.array([[1.0]]), np.array([0.125]), "linear", quantiser=quantiser),
        Dense(np.array([[0.5]]), np.array([0.0])),
    ]
    (whole,) = integer_networks("single", [network_of(layers)])
    layer, last = whole.layers
    assert (layer.rounding, layer.low, layer.high, layer.cut) == (LayerRounding.EVEN, 0, 7, 14)
    assert layer.shift == DROPPED + layer.cut
    assert last.rounding is LayerRounding.DOWN
    samples = np.array([[-1.0], [-0.5], [-0.25], [0.0], [0.25], [0.5], [0.75]])
    frames, _ = SIGNAL.quantise(samples)
    # (x + 1/8) / (1/4) + 2: -1.5, 0.5, 1.5, 2.5, 3.5, 4.5 and 5.5
    assert whole.hidden_codes(frames)[0].ravel().tolist() == [0, 0, 2, 2, 4, 4, 6]
    found = SIGNAL.to_real(evaluate([whole], frames)).ravel()
    assert found.tolist() == [-0.25, -0.25, 0.0, 0.0, 0.25, 0.25, 0.5]


def test_a_quantiser_behind_what_is_not_exact_can_be_a_step_off() -> None:
    quantiser = Quantiser(2.0**-3, 0, 0, 15)
    layers = random_network((4, 5, 3, 2), ("relu", "relu"), 1.0, 3, quantiser).layers
    weights = np.abs(layers[-1].weights).sum(axis=1)
    first = Dense(layers[0].weights, layers[0].biases, "tanh")
    network = network_of([first, *layers[1:]])
    bounds = engine_bounds(network, 9, 4)
    assert (bounds >= weights * quantiser.scale).all()


UNBOUNDED = ("relu", "leaky_relu", "linear")


def quiet(inputs: int, count: int, seed: int = 1) -> Codes:
    """Frames in which samples of equal sign are rare, so sums stay far below their bounds."""
    return np.random.default_rng(seed).integers(-1500, 1501, (count, inputs))


def wide(kinds: tuple[str, ...] = ("relu", "relu"), seed: int = 1) -> DenseNetwork:
    """A network whose bounds are far above what quiet frames reach, with outputs below 1 there."""
    made = random_network((24, *(4 for _ in kinds), 2), kinds, 4.0, seed)
    *layers, last = made.layers
    most = 1.5 * np.abs(made.process(SIGNAL.to_real(quiet(24, 500, seed + 10)))).max()
    return DenseNetwork((*layers, Dense(last.weights / most, last.biases / most)))


def of_frames(network: DenseNetwork, codes: Codes, lean: bool = True, **options: object) -> Engine:
    met = hidden_peaks(network, SIGNAL.to_real(codes))
    return Engine.of([network], Settings(met=(met,), options=options, lean=lean))


@settings(max_examples=60)
@given(met=st.floats(1e-4, 60_000))
def test_a_range_from_the_data_holds_the_margin_and_no_bit_more(met: float) -> None:
    frac = frac_of(met, WIDTH)
    assert MARGIN * met * 2**frac < 2 ** (WIDTH - 1)
    assert frac == WIDTH - 1 or met * 2**frac >= 2**ENOUGH


@pytest.mark.parametrize("kind", UNBOUNDED)
def test_the_largest_magnitudes_are_those_of_the_words(kind: str) -> None:
    network, codes = wide((kind, kind)), quiet(24, 50)
    engine = of_frames(network, codes, lean=False)
    (whole,) = engine.integers
    layers = zip(hidden_peaks(network, SIGNAL.to_real(codes)), engine.graph.ranges, strict=True)
    for depth, (found, one) in enumerate(layers):
        _, words = list(whole.run(sample_words(codes)))[depth]
        assert one.fmt.to_real(np.abs(words).max()) == pytest.approx(found, abs=0.02)
        assert one.met == found


@pytest.mark.parametrize("kind", UNBOUNDED)
def test_the_data_give_bits_where_bounds_waste_them(kind: str) -> None:
    """On the recorded frames and up to the margin nothing saturates, and the error is smaller."""
    network, codes = wide((kind, kind)), quiet(24, 200)
    bounded, ranged = Engine.of([network]), of_frames(network, codes)
    first, other = bounded.graph.ranges[0], ranged.graph.ranges[0]
    assert other.met * 2**first.fmt.frac < 2**ENOUGH
    assert other.from_data
    gained = 0
    for one, other in zip(bounded.graph.ranges, ranged.graph.ranges, strict=True):
        assert not one.from_data
        assert (one.met, other.bound >= other.met) == (0.0, True)
        assert 0.99 * 2 ** (WIDTH - 2) < one.bound * 2**one.fmt.frac < 2 ** (WIDTH - 1)
        assert other.met * 2**other.fmt.frac >= 2**ENOUGH or other.fmt.frac == WIDTH - 1
        gained += other.fmt.frac - one.fmt.frac
    assert gained >= 2
    assert not any(counts.any() for counts in ranged.saturations(codes).values())
    assert not any(counts.any() for counts in ranged.saturations(MARGIN * codes * 2 // 3).values())
    real = np.clip(network.process(SIGNAL.to_real(codes)), -1, SIGNAL.to_real(SIGNAL.high))
    errors = [np.abs(SIGNAL.to_real(e.process(codes)) - real).mean() for e in (bounded, ranged)]
    outputs = np.abs(SIGNAL.to_real(SIGNAL.quantise(real)[0]) - real).mean()
    assert errors[1] - outputs < 0.5 * (errors[0] - outputs)


@pytest.mark.parametrize("kind", UNBOUNDED)
def test_saturations_are_counted_and_part_of_the_twin(kind: str) -> None:
    network = wide((kind, "tanh", kind), seed=3)
    engine = of_frames(network, quiet(24, 50))
    rng = np.random.default_rng(2)
    codes = np.concatenate(
        [quiet(24, 20, seed=5), rng.choice([SIGNAL.low, 0, SIGNAL.high], (60, 24))]
    )
    assert np.array_equal(engine.process(codes), exact(engine, codes))
    found = engine.saturations(codes)
    ranges = [one for one in engine.graph.ranges if one.from_data]
    assert [one.layer for one in ranges] == list(found)
    assert "layer 1" in found
    (whole,) = engine.integers
    for one in ranges:
        depth = int(one.layer.removeprefix("layer ")) - 1
        layer = whole.layers[depth]
        built = [engine.graph.neurons[place].name.split("node ")[1] for place in one.places]
        nodes = [int(name.split()[0]) - 1 for name in built]
        sums, _ = list(whole.run(sample_words(codes)))[depth]
        rounded = layer.rounded(sums[:, nodes])
        beyond = (rounded > one.fmt.high) | ((rounded < one.fmt.low) & (not layer.rectifies))
        assert found[one.layer].tolist() == beyond.sum(axis=1).tolist()
    assert found["layer 1"].any()


@settings(max_examples=30)
@given(seed=st.integers(0, 999), kinds=st.lists(st.sampled_from(UNBOUNDED), min_size=1, max_size=3))
def test_the_bounds_of_the_error_hold_where_nothing_saturates(seed: int, kinds: list[str]) -> None:
    network = wide(tuple(kinds), seed)
    engine = of_frames(network, quiet(24, 30, seed))
    codes = np.concatenate([quiet(24, 30, seed + 1), 4 * quiet(24, 30, seed + 2)])
    counts = [np.zeros(len(codes), dtype=np.int64), *engine.saturations(codes).values()]
    sound = np.sum(counts, axis=0) == 0
    real = np.clip(network.process(SIGNAL.to_real(codes)), -1, SIGNAL.to_real(SIGNAL.high))
    off = np.abs(SIGNAL.to_real(engine.process(codes)) - real)
    met = hidden_peaks(network, SIGNAL.to_real(quiet(24, 30, seed)))
    assert sound.any()
    assert (off[sound] <= engine_bounds(network, 9, 24, met)).all()


# In scenes.


def recorded_scene(folder: Path, network: DenseNetwork, recorded: Codes) -> Scene:
    """A scene whose recording has these codes, and outputs of the network as targets."""
    path = write_scene(folder, "rig", "exact", [network], activation="precise", design="engine")
    samples = SIGNAL.to_real(recorded)
    targets = np.clip(np.abs(network.process(samples)), 0.01, 0.9)
    names = [*(f"x{k}" for k in range(samples.shape[1])), "y0", "y1"]
    rows = np.concatenate([samples, targets], axis=1)
    text = [",".join(names), *(",".join(f"{v!r}" for v in row) for row in rows.tolist())]
    (folder / "rig.csv").write_text("\n".join(text) + "\n")
    return load_scene(str(path))


def test_a_scene_takes_its_ranges_from_all_recorded_frames(tmp_path: Path) -> None:
    network, codes = wide(), quiet(24, 40)
    scene = recorded_scene(tmp_path, network, codes)
    engine = scene.twin()
    assert engine == of_frames(network, codes)
    assert scene.build(network) == engine
    assert scene.twin(lean=False).core.process(codes).tolist() == engine.process(codes).tolist()
    lines = range_lines(scene, scene.twin().core.saturations(scene.vectors().codes))
    assert [line.split(":")[0] for line in lines] == ["layer 1", "layer 2"]
    met = engine.graph.ranges[0].met
    assert f"from the data: {met:.4g} is met, margin 2; bounds would be" in lines[0]
    assert lines[0].endswith("; no sum saturates in 40 recorded frames")
    found = everything(scene, tmp_path / "build")
    assert set(lines) <= {finding.text for finding in found if finding.verdict == OK}
    assert not [f for f in found if f.verdict == WARNING and "saturate" in f.text]
    sentences = built(scene, engine)
    assert any("from the data" in sentence and sentence[0] == "L" for sentence in sentences)


def test_hidden_sums_that_saturate_in_recorded_frames_are_warned_of(
    tmp_path: Path, monkeypatch
) -> None:
    """With the margin none can, so it is taken away."""
    first, *others = wide().layers
    larger = DenseNetwork((Dense(8 * first.weights, first.biases, "relu"), *others))
    scene = recorded_scene(tmp_path, larger, quiet(24, 40))
    assert not [text for text in saturating(scene) if "layer" in text]
    monkeypatch.setattr("golden.engine.ranges.MARGIN", 0.1)
    again = load_scene(str(scene.path))
    (first, *_) = [text for text in saturating(again) if "layer" in text]
    counts = again.twin().core.saturations(again.vectors().codes)["layer 1"]
    assert first == (
        f"layer 1: {counts.sum()} sums saturate, in {(counts > 0).sum()} of 40 recorded frames"
    )


def test_predict_counts_what_new_readings_saturate(tmp_path: Path, capsys) -> None:
    scene = recorded_scene(tmp_path, wide(), quiet(24, 60))
    new = quiet(24, 6, seed=9)
    weights = scene.networks()[0].layers[0].weights
    new[2] = np.where(weights[0] > 0, SIGNAL.high, SIGNAL.low)
    header = [f"x{k}" for k in range(24)]
    text = [",".join(header)]
    text += [",".join(map(str, row)) for row in SIGNAL.to_real(new).tolist()]
    (tmp_path / "new.csv").write_text("\n".join(text) + "\n")
    call("predict", scene.path, tmp_path / "new.csv", tmp_path / "out.csv")
    out = capsys.readouterr().out
    count = scene.twin().core.saturations(new)["layer 1"]
    assert count[2]
    assert f"; {count.sum()} sums saturate, in {(count > 0).sum()} of 6 rows" in out
    with (tmp_path / "out.csv").open() as file:
        reasons = [row["reason"] for row in csv.DictReader(file)]
    assert ["layer 1 saturates" in reason for reason in reasons] == (count > 0).tolist()


@pytest.mark.parametrize(
    ("name", "clocks"),
    [("digit", 236), ("comparison/digit-lanes2", 153), ("comparison/digit-lanes4", 130)],
)
def test_the_overview_tells_the_clocks(name: str, clocks: int) -> None:
    assert load_scene(name).twin().interval == clocks
    assert re.search(rf"\b{clocks}\b", PAGE.with_name("overview.md").read_text("utf-8"))


def test_an_engine_leaves_out_the_steps_of_weights_of_0() -> None:
    network = random_mlp((3, 4, 2), 1.0, 1)
    network.layers[0].weights[:, 0] = network.layers[1].weights[:, -1] = 0
    whole = integer_networks("single", [network])
    terms = [sum(len(n.terms) for n in graph_of(whole, lean).neurons) for lean in (False, True)]
    assert terms[0] - terms[1] == 11
