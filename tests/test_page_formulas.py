"""Formulas that pages state, compared with what the twins publish."""

import math
import re
from fractions import Fraction

import numpy as np
import pytest
from pages import DOCS
from shared import Shared

from golden.common.block import walk
from golden.engine.graph import Kind
from golden.layers.constant_matrix import ConstantMatrix
from golden.layers.listing import listing
from golden.layers.shift_add import Sum
from golden.networks.adder_graph import AdderGraph
from golden.networks.constants import constants_of
from golden.networks.engine import Engine
from golden.sensing.scan import Scan
from tactus.core.fingerprint import ROOT
from tactus.scene import load_scene, scene_names
from tactus.scene.image import hex_text
from tactus.verify.benches.collected import CASES, CASES_OF

pytestmark = pytest.mark.pages

COMPARISON = ROOT / "scenes" / "comparison"


@pytest.fixture(scope="module")
def engines(shared: Shared) -> dict[str, Engine]:
    """The engines of shipped scenes, those for comparison, and cases, by name."""
    named = {name: name for name in scene_names()}
    named |= {path.name: str(path / f"{path.name}.toml") for path in COMPARISON.iterdir()}
    scenes = {name: load_scene(path) for name, path in named.items()}
    scenes |= {name: shared.scene(name) for name in CASES_OF["engine"] if name in CASES}
    found: dict[str, Engine] = {}
    for name, scene in scenes.items():
        if scene.design == "engine" and not scene.learning:
            (found[name],) = (b for b in walk(scene.twin()) if isinstance(b, Engine))
    return found


def test_words_that_are_read(engines: dict[str, Engine]) -> None:
    """The counter runs until the clock of the last output, to one word after the padding."""
    for name, engine in engines.items():
        if engine.serial:
            continue
        pipeline, last = engine.program.pipeline, engine.output_clocks[-1]
        clock = np.arange(last + 4)
        run = (clock >= pipeline.run) & (clock <= last)
        read = engine.program_memory.counter(
            clock == pipeline.run - 1, run, clock == last, np.zeros(len(clock))
        )
        begin, memory = len(engine.program.table), len(engine.program_memory.contents)
        end = max(n for n, word in enumerate(engine.program.words) if word >> 35)
        behind = pipeline.padding + 1
        expected = {(begin + n) % memory for n in range(end + behind + 1)}
        assert set(read.tolist()) == expected, name
        # An image contains these words too, so that they are defined.
        assert engine.loaded is not None or len(engine.program.words) == end + behind, name


def test_a_later_networks_bias_is_rounded_once(engines: dict[str, Engine]) -> None:
    scene, graph = load_scene("digit"), engines["digit"].graph
    sums = {neuron.name: neuron for neuron in graph.neurons if neuron.name.endswith(" sum")}
    rounded_apart = 0
    for number, mlp in enumerate(scene.mlps(), 1):
        for j, b in enumerate(mlp.b1.tolist(), 1):
            terms = sums[f"network {number} node {j} sum"].terms
            bias = sum(term.weight for term in terms if term.kind is Kind.ONE)
            w = sum(t.weight for t in terms if t.kind is Kind.WORD and t.source >= graph.inputs)
            half = Fraction(w, 2**14 * 2**11)
            assert bias == math.floor(2**14 * (Fraction(b) - half) + Fraction(1, 2))
            apart = [math.floor(2**14 * part + Fraction(1, 2)) for part in (Fraction(b), half)]
            rounded_apart += bias != apart[0] - apart[1]
    assert rounded_apart


def test_hex_is_padded_to_the_memory_and_bin_is_not(engines: dict[str, Engine]) -> None:
    for name in ("digit-reload", "rails-reload", "deep-reload"):
        image = engines[name].loaded
        assert image is not None
        lines, count = hex_text(image).split(), len(image.words)
        assert len(lines) == image.sizes.program_words > count, name
        assert set(lines[count:]) == {"000000000"}
        assert [int(line, 16) for line in lines[:count]] == list(image.words)
        assert len(image.to_bytes()) == 5 + 5 * count + 2


def test_how_soon_outputs_are_there(engines: dict[str, Engine]) -> None:
    """The figures are those of docs/future-work.md."""
    page = " ".join((DOCS / "future-work.md").read_text(encoding="utf-8").split())
    found = re.search(r"less than (\d+) us after the last sample of a scan of (\d+) us", page)
    assert found
    scene = load_scene("digit-instrument")
    scan = next(b.scan_clocks for b in walk(scene.twin()) if isinstance(b, Scan))
    last = engines["digit-instrument"].output_clocks[-1]
    assert [int(text) for text in found.groups()] == [
        math.ceil(last / scene.clock_mhz),
        scan / scene.clock_mhz,
    ]


@pytest.fixture(scope="module", params=["digit-fast", *CASES_OF["adder_graph"]])
def adders(request: pytest.FixtureRequest, shared: Shared) -> AdderGraph:
    core = shared.scene(request.param).twin().core
    assert isinstance(core, AdderGraph)
    return core


def matrices(design: AdderGraph) -> list[ConstantMatrix]:
    return [*design.layers]


def test_bits_are_cut(adders: AdderGraph) -> None:
    """A node keeps the lowest place that any of its users needs."""
    for matrix in matrices(adders):
        graph = matrix.graph
        p = max(0, matrix.out_shift - matrix.guard)
        asked: list[list[int]] = [[] for _ in graph.nodes]
        for row in graph.rows:
            asked[row.node].append(max(0, p - row.shift))
        for place in reversed(range(len(graph.nodes))):
            node = graph.nodes[place]
            if isinstance(node, Sum):
                kept = min(asked[place])
                assert graph.lows[place] == kept
                for one in node.operands:
                    asked[one.node].append(max(0, kept - one.shift))
            else:
                assert graph.lows[place] == 0


def test_a_listing_computes_what_the_matrix_does(adders: AdderGraph) -> None:
    rng = np.random.default_rng(1)
    for matrix in matrices(adders):
        frames = rng.integers(matrix.in_fmt.low, matrix.in_fmt.high + 1, (50, matrix.inputs))
        names = {f"in_data_{k}": frames[:, k] for k in range(matrix.inputs)}
        for line in listing(matrix)[2:]:
            name, _, what = line.split(maxsplit=2)
            names[name] = eval(what, {"__builtins__": {}}, names)
        results = [names[f"out_data_{i}"] for i in range(len(matrix.weights))]
        # A row without weights is a constant.
        found = np.stack([np.broadcast_to(one, len(frames)) for one in results], axis=-1)
        low, high = matrix.out_fmt.low, matrix.out_fmt.high
        assert np.array_equal(np.clip(found, low, high), matrix.process(frames))


def test_the_sums_of_an_adder_graph() -> None:
    """The constants of both matrices, from the codes of one network."""
    scene = load_scene("digit-fast")
    core = scene.twin().core
    (mlp,) = scene.mlps()
    constants = constants_of(mlp, scene.settings())
    first, second = constants.first, constants.second
    hidden, outputs = core.layers
    assert hidden.weights == first.weights
    assert hidden.biases == tuple(bias * 2**13 for bias in first.biases)
    assert hidden.out_shift == first.fmt.frac - 1
    shift = outputs.out_shift
    assert shift == second.fmt.frac + 1
    assert outputs.biases == tuple(
        bias * 2**14 + sum(row) // 2 + 2 ** (shift - 1)
        for row, bias in zip(second.weights, second.biases, strict=True)
    )
    for matrix in matrices(core):
        assert matrix.place == matrix.out_shift - 1
