"""Files and listings that pages describe, compared with what the twins compute."""

import math
import re
from fractions import Fraction

import numpy as np
import pytest
from pages import DOCS
from shared import Shared

from golden.common.block import walk
from golden.engine.graph import Kind
from golden.layers.listing import listing
from golden.layers.shift_add import Sum
from golden.networks.adder_graph import AdderGraph
from golden.networks.constants import constants_of
from golden.networks.engine import Engine
from golden.sensing.scan import Scan
from tactus.scene import load_scene
from tactus.scene.image import hex_text
from tactus.verify.benches.collected import CASES_OF

pytestmark = pytest.mark.pages


def test_hex_is_padded_to_the_memory_and_bin_is_not(shared: Shared) -> None:
    for name in ("digit-reload", "rails-reload", "deep-reload"):
        (engine,) = (b for b in walk(shared.scene(name).twin()) if isinstance(b, Engine))
        image = engine.loaded
        assert image is not None
        lines, count = hex_text(image).split(), len(image.words)
        assert len(lines) == image.sizes.program_words > count, name
        assert set(lines[count:]) == {"000000000"}
        assert [int(line, 16) for line in lines[:count]] == list(image.words)
        assert len(image.to_bytes()) == 5 + 5 * count + 2


@pytest.fixture(scope="module", params=["digit-fast", *CASES_OF["adder_graph"]])
def adders(request: pytest.FixtureRequest, shared: Shared) -> AdderGraph:
    core = shared.scene(request.param).twin().core
    assert isinstance(core, AdderGraph)
    return core


def test_a_listing_computes_what_the_matrix_does(adders: AdderGraph) -> None:
    rng = np.random.default_rng(1)
    for matrix in adders.layers:
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


def engine(name: str) -> Engine:
    (found,) = (block for block in walk(load_scene(name).twin()) if isinstance(block, Engine))
    return found


def test_a_later_networks_bias_is_rounded_once() -> None:
    scene, graph = load_scene("digit"), engine("digit").graph
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


def test_bits_are_cut(adders: AdderGraph) -> None:
    """A node keeps the lowest place that any of its users needs."""
    for matrix in adders.layers:
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
    for matrix in core.layers:
        assert matrix.place == matrix.out_shift - 1


def test_how_soon_outputs_are_there() -> None:
    """The figures are those of docs/future-work.md."""
    page = " ".join((DOCS / "future-work.md").read_text(encoding="utf-8").split())
    found = re.search(r"less than (\d+) us after the last sample of a scan of (\d+) us", page)
    assert found
    scene = load_scene("digit-instrument")
    scan = next(b.scan_clocks for b in walk(scene.twin()) if isinstance(b, Scan))
    last = engine("digit-instrument").output_clocks[-1]
    assert [int(text) for text in found.groups()] == [
        math.ceil(last / scene.clock_mhz),
        scan / scene.clock_mhz,
    ]
