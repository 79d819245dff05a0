"""The design table_graph: functions in small tables, sums of them, and what it refuses."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from golden.networks.design import Settings
from golden.networks.oracle import error_bounds, hidden_weights
from golden.networks.small_tables import FINE, MOST_ADDRESS, tables_of
from golden.networks.table_graph import GUARD, TableGraph
from golden.networks.table_sums import function_sums
from golden.numbers.precision import EXACT, SIGNAL
from golden.trained.function_network import FunctionNetwork
from tactus.errors import decisions_of, held_out_or_all, provenances
from tactus.scene import load_scene
from tb.common.cases import random_learned

ONE = 1 << FINE
FEW = {"sample_bits": 7, "hidden_bits": 8, "output_bits": 9}


def frames(inputs: int, seed: int = 1, count: int = 400) -> np.ndarray:
    found = np.random.default_rng(seed).integers(SIGNAL.low, SIGNAL.high + 1, (count, inputs))
    found[0], found[1] = SIGNAL.low, SIGNAL.high
    return found


def graph(network: FunctionNetwork, **options: int) -> TableGraph:
    return TableGraph.of([network.layers()], Settings(options=FEW | options))


def read(tables: tuple, width: int) -> np.ndarray:
    """The sum of tables at every code, from its least, as a circuit looks it up."""
    found = []
    for code in range(-(1 << width - 1), 1 << width - 1):
        bits = f"{code & (1 << width) - 1:0{width}b}"
        total = 0
        for table in tables:
            part = table.part
            lower = bits[width - part.high : width - part.low]
            total += table.words[int(bits[: part.top] + lower, 2)]
        found.append(total)
    return np.array(found)


@settings(max_examples=20, deadline=None)
@given(st.integers(4, 10), st.integers(0, 1000), st.integers(1, 400))
def test_tables_are_near_to_a_smooth_function(width: int, seed: int, size: int) -> None:
    """Every address fits a LUT of six inputs, and the square mean of the errors is as asked."""
    a, b, c = np.random.default_rng(seed).normal(0, 1, 3)
    x = np.linspace(-1, 1, 1 << width)
    values = np.rint(size * ONE * (a * x + b * x**2 + 0.2 * c * x**3)).astype(np.int64)
    tables = tables_of(3, values, ONE)
    assert all(table.source == 3 and table.part.width <= MOST_ADDRESS for table in tables)
    off = (read(tables, width) * ONE - values) / ONE
    assert np.sqrt((off**2).mean()) <= 1


def test_a_function_within_half_a_step_needs_no_table() -> None:
    assert tables_of(0, np.full(1 << 8, ONE // 3), ONE) == ()


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("spread", [0.5, 3.0])
def test_outputs_are_within_their_bounds(seed: int, spread: float) -> None:
    """Without recorded frames a hidden sum has its whole range, and so the bound always holds."""
    network = random_learned((3, 2, 2), 0, spread, seed)
    design, layers = graph(network), network.layers()
    codes = frames(3, seed)
    real = layers.process(SIGNAL.to_real(codes)).clip(-1, SIGNAL.to_real(SIGNAL.high))
    off = np.abs(SIGNAL.to_real(design.process(codes)) - real).max(axis=0)
    bounds = error_bounds(design, layers, EXACT, 3)
    assert (off <= bounds).all()
    assert (off > bounds / 50).all()


def test_recorded_frames_give_the_range_of_a_hidden_sum() -> None:
    """Its word is finer then, and sums beyond it are counted."""
    network = random_learned((2, 2, 2), 0, 1.0, 3).layers()
    codes = frames(2) // 2
    real = SIGNAL.to_real(codes)
    *_, sums, _ = network.layers
    copies = network.layers[0]
    values, _ = copies.activate(real @ copies.weights.T + copies.biases)
    reached = values @ sums.weights.T + sums.biases
    ends = [tuple(zip(reached.min(axis=0).tolist(), reached.max(axis=0).tolist(), strict=True))]
    fine = TableGraph.of([network], Settings(options=FEW, reached=ends))
    coarse = TableGraph.of([network], Settings(options=FEW))

    def off(design: TableGraph) -> np.ndarray:
        return np.abs(SIGNAL.to_real(design.process(codes)) - network.process(real)).mean(axis=0)

    assert (off(fine) < off(coarse)).all()
    assert not fine.saturations(codes)["layer of hidden sums"].any()
    assert fine.saturations(2 * codes)["layer of hidden sums"].any()
    assert not coarse.saturations(2 * codes)["layer of hidden sums"].any()


def test_the_ends_of_hidden_sums_are_those_of_all_frames() -> None:
    design = graph(random_learned((2, 2, 1), 0, 1.0, 3))
    low, high = design.extremes[0::2], design.extremes[1::2]
    every = np.arange(SIGNAL.low, SIGNAL.high + 1, 1 << 7)
    both = np.stack(np.meshgrid(every, every), axis=-1).reshape(-1, 2)
    for h in range(2):
        row = np.array(design.hidden.weights[h])
        sums = design.hidden_words(both) @ row
        assert (design.hidden_words(low[[h]]) @ row)[0] == sums.min()
        assert (design.hidden_words(high[[h]]) @ row)[0] == sums.max()
    assert hidden_weights(design) == high.tolist()


def test_nothing_is_built_that_changes_no_output() -> None:
    """A sum that no output takes, one without an edge, an edge that is left out."""
    made = random_learned((2, 4, 2), 0, 1.0, 3)
    first, second = ([list(edges) for edges in layer] for layer in (made.first, made.second))
    used = graph(made)
    for edges in second:
        edges[0] = None
    first[1] = [None, None]
    first[2][0] = None
    network = replace(made, first=first, second=second, offsets=[0.0, 0.1, 0.0, 0.0])
    design = graph(network)
    assert (used.useless_nodes, used.constant_nodes, len(used.hidden.weights)) == (0, 0, 4)
    assert len(design.hidden.weights) == 2
    assert len(design.first) < len(used.first) * 3 // 4
    texts = " ".join(design.left_out())
    assert "multiplier" in texts
    codes = frames(2)
    real = network.layers().process(SIGNAL.to_real(codes)).clip(-1, 1)
    assert (np.abs(SIGNAL.to_real(design.process(codes)) - real) <= design.bounds).all()


def test_a_scene_that_decides() -> None:
    """It errs on held-out rows as often as its provenance says."""
    scene = load_scene("comparison/wine-tables")
    design = scene.twin()
    assert isinstance(design, TableGraph)
    assert design.decides
    assert (design.interval, design.samples) == (1, len(scene.sensors))
    assert not design.saturations(scene.vectors().codes)["layer of hidden sums"].any()
    held_out, _ = held_out_or_all(scene, decisions_of(scene))
    (story,) = provenances(scene)
    wrong = 100 * (len(held_out.actual) - held_out.right) / len(held_out.actual)
    assert wrong == pytest.approx(story["test_wrong_percent"], abs=1e-4)
    assert len(held_out.actual) - held_out.right == 1


@pytest.mark.parametrize("bits", [8, 11])
def test_training_knows_how_far_hidden_words_are_from_their_sums(bits: int) -> None:
    scene = load_scene("comparison/digit-tables")
    options = scene.design_options | {"hidden_bits": bits}
    scene = replace(scene, design_options=options)
    given_settings = scene.settings()
    design = scene.twin()
    network = function_sums(scene.networks()[0], given_settings.reached[0], TableGraph.block)
    codes = scene.vectors().codes
    cut = SIGNAL.width - design.sample_bits
    # The middle of what a word of the bits that tables read stands for.
    samples = SIGNAL.to_real(codes >> cut << cut) + ((1 << cut) - 1) / 2 * 2.0**-SIGNAL.frac
    words = design.hidden.process(design.hidden_words(codes))
    parts = []
    for word, one, (low, high) in zip(words.T, network.hidden, network.ranges, strict=True):
        sums = one.constant + sum(curve.at(samples[:, k]) for k, curve in one.curves.items())
        # A word lacks the last bits of the sum of the tables, on average half of what they hold.
        lost = (1 - 2.0**-GUARD) / 2
        read_sums = (low + high) / 2 + (high - low) * (word + lost) / (1 << bits)
        parts.append((read_sums - sums) / np.ptp(sums))
    found = float(np.sqrt(np.mean(np.square(parts))))
    # Tables are as near as their tolerance or nearer, and some functions are straight or left out.
    expected = TableGraph.word_error(design.inputs, options)
    assert 0.5 * expected < found < expected
