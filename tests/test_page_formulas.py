"""Computes the formulas of datasheets, and compares them with what the twins publish."""

import math
import re
from collections.abc import Iterator
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from pages import DOCS, cells
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
from tactus.report.page.made import made
from tactus.scene import load_scene, scene_names
from tactus.scene.write_image import hex_text
from tactus.verify.benches.collected import CASES, CASES_OF

pytestmark = pytest.mark.pages

PAGE = (DOCS / "blocks" / "engine.md").read_text(encoding="utf-8")
TEXT = " ".join(PAGE.split())
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


def row(name: str, registers: int) -> int:
    """The clocks that the table of the pipeline on the site gives."""
    return int(cells(made("pipeline"), f"`{name}`")[registers])


def test_step_n_leaves_in_clock_begin_n_result(engines: dict[str, Engine]) -> None:
    assert "leaves in clock `begin` + n + `result` after the last sample" in TEXT
    registers = set()
    for name, engine in engines.items():
        if engine.serial:
            continue
        deep = engine.program.pipeline.memory_registers
        registers.add(deep)
        found = [row("begin", deep) + n + row("result", deep) for n in engine.program.output_steps]
        assert tuple(found) == engine.output_clocks, name
    assert registers == {0, 1}


def neurons(engine: Engine) -> Iterator[tuple[int, int, int, bool]]:
    """For each neuron: its words, its deep or wide words, its deep words, and whether it is an
    output.

    They are decoded from the words by the fields of docs/blocks/replay_memory.md.
    """
    group: list[int] = []
    words = engine.program.words
    for word, following in pairwise(words):
        kind, source = word >> 28 & 3, word >> 18 & 1023
        deep = kind == Kind.DISTANCE or (kind == Kind.WORD and source >= engine.inputs)
        group.append(2 if deep else 1 if kind == Kind.WORD else 0)
        if word >> 30 & 3 == 3:
            wide, far = (
                max((k + 1 for k, depth in enumerate(group) if depth >= least), default=1)
                for least in (1, 2)
            )
            yield len(group), wide, far, (following >> 33 & 3) >= 2
            group = []


def test_clocks_without_a_multiplier(engines: dict[str, Engine]) -> None:
    assert "1 + n + 14 w + 3 d" in PAGE
    assert "1 + n + 14 w + 3 d clocks" in (DOCS / "blocks" / "replay_memory.md").read_text()
    assert "leaves in clock `begin` + c - 1 + `result` after the last sample" in TEXT
    stated = re.search(
        r"`done` is (\d+), `result` (\d+) and `result_ready` (\d+); `begin` and `free` are (\d+)",
        TEXT,
    )
    assert stated
    done, result, ready, begin = map(int, stated.groups())
    serial = {name: engine for name, engine in engines.items() if engine.serial}
    assert {"digit-serial", "digit-single-serial"} < serial.keys()
    for name, engine in serial.items():
        pipeline = engine.program.pipeline
        published = (pipeline.done, pipeline.result, pipeline.result_ready, pipeline.begin)
        assert published == (done, result, ready, begin), name
        assert pipeline.free == begin, name
        clocks, found = 0, []
        for n, w, d, leaves in neurons(engine):
            clocks += 1 + n + 14 * w + 3 * d
            if leaves:
                found.append(begin + clocks - 1 + result)
        assert tuple(found) == engine.output_clocks, name


def test_the_interval(engines: dict[str, Engine]) -> None:
    assert "last output + free + samples - 1" in PAGE
    for name, engine in engines.items():
        free = row("free", engine.program.pipeline.memory_registers)
        assert engine.interval == engine.output_clocks[-1] + free + engine.inputs - 1, name
    printed = re.findall(r"(\d+) \+ (\d+) \+ (\d+) - 1 = (\d+) (?:clocks )?for `([\w-]+)`", TEXT)
    assert [name for *_, name in printed] == ["digit", "digit-serial"]
    for *figures, name in printed:
        engine = engines[name]
        last, free, samples, interval = map(int, figures)
        assert last == engine.output_clocks[-1]
        assert (samples, interval) == (engine.inputs, engine.interval)
        assert last + free + samples - 1 == interval


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
        behind = row("padding", pipeline.memory_registers) + 1
        expected = {(begin + n) % memory for n in range(end + behind + 1)}
        assert set(read.tolist()) == expected, name
        # An image contains these words too, so that they are defined.
        assert engine.loaded is not None or len(engine.program.words) == end + behind, name


def test_a_later_networks_bias_is_rounded_once(engines: dict[str, Engine]) -> None:
    assert "floor(2^14 (b - 2^-14 (sum of w) 2^-11) + 1/2)" in PAGE
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


def test_bits_are_cut_as_the_page_says(adders: AdderGraph) -> None:
    """Applies the rules of docs/blocks/constant_matrix.md to nodes, their shifts and rows."""
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


def test_the_page_shows_lines_of_a_listing_of_adders() -> None:
    page = (DOCS / "blocks" / "constant_matrix.md").read_text(encoding="utf-8")
    name, text = re.search(r"`make listing SCENE=([\w-]+)`:\n\n```\n(.*?)```", page, re.S).groups()
    shown = [line for line in text.splitlines() if line != "..."]
    assert len(shown) > 5
    lines = listing(load_scene(name).twin().core.layers[0])
    assert [line for line in lines if line in shown] == shown


def test_the_sums_of_an_adder_graph() -> None:
    """Tests the table of docs/blocks/adder_graph.md, which is for one network and its codes."""
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
