"""Compares graphs of shifted adds with whole numbers, and truncation with its bounds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from golden.fixed import Fix
from golden.input_error import InputError
from golden.layers import sharing
from golden.layers.constant_matrix import ConstantMatrix
from golden.layers.sharing import shared
from golden.layers.shift_add import Sum
from golden.signed_digits import signed_digits

SAMPLES = Fix(6, 5)
WIDE = Fix(40, 5)
WEIGHT = st.integers(-(1 << 11), 1 << 11)


@pytest.fixture(autouse=True, scope="module")
def _few_runs() -> Iterator[None]:
    """Limit the number of runs. More runs only find smaller graphs."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sharing, "RUNS", 2)
        shared.cache_clear()
        yield
    shared.cache_clear()


@st.composite
def matrices(draw: st.DrawFn) -> ConstantMatrix:
    """Small matrices of any shape, in which some weights are 0."""
    inputs, rows = draw(st.integers(1, 4)), draw(st.integers(1, 4))
    weights = draw(
        st.lists(
            st.lists(st.one_of(st.just(0), WEIGHT), min_size=inputs, max_size=inputs),
            min_size=rows,
            max_size=rows,
        )
    )
    biases = draw(st.lists(st.integers(-(1 << 16), 1 << 16), min_size=rows, max_size=rows))
    return ConstantMatrix(
        SAMPLES,
        WIDE,
        tuple(map(tuple, weights)),
        tuple(biases),
        draw(st.integers(0, 8)),
        draw(st.integers(0, 3)),
        draw(st.integers(1, 6)),
    )


def products(matrix: ConstantMatrix, frames: np.ndarray) -> np.ndarray:
    """The exact sums, in Python's integers."""
    return frames.astype(object) @ np.array(matrix.weights, dtype=object).T + np.array(
        matrix.biases, dtype=object
    )


def some_frames(matrix: ConstantMatrix) -> np.ndarray:
    """Frames for the ends of each sum, and random frames."""
    ends = [frame for pair in matrix.ends for frame in pair]
    fmt = matrix.in_fmt
    random = np.random.default_rng(3).integers(fmt.low, fmt.high + 1, (40, matrix.inputs))
    return np.concatenate([np.array(ends), random])


@settings(max_examples=30, deadline=None)
@given(matrices())
def test_nothing_cut_is_the_exact_product(matrix: ConstantMatrix) -> None:
    whole = replace(matrix, guard=matrix.out_shift)
    frames = some_frames(whole)
    assert (whole.process(frames) == products(whole, frames) >> whole.out_shift).all()
    assert set(whole.errors) == {(0, 0)}


@settings(max_examples=30, deadline=None)
@given(matrices())
def test_what_is_cut_is_within_its_bounds(matrix: ConstantMatrix) -> None:
    frames = some_frames(matrix)
    exact, results = products(matrix, frames), matrix.process(frames)
    for i, (below, above) in enumerate(matrix.errors):
        assert (results[:, i] >= (exact[:, i] + below) >> matrix.out_shift).all()
        assert (results[:, i] <= (exact[:, i] + above) >> matrix.out_shift).all()


@settings(max_examples=30, deadline=None)
@given(matrices())
def test_no_number_leaves_its_bounds_and_none_comes_late(matrix: ConstantMatrix) -> None:
    graph = matrix.graph
    numbers = graph.numbers(some_frames(matrix).T)
    for number, (low, high) in zip(numbers, graph.bounds, strict=True):
        assert low <= number.min()
        assert number.max() <= high
    assert graph.depth + matrix.saturates <= matrix.latency * matrix.adders_per_clock
    for place, node in enumerate(graph.nodes):
        if isinstance(node, Sum):
            assert max(node.low, node.high) < place
            assert graph.step(place).low_cut >= 0


@settings(max_examples=30, deadline=None)
@given(matrices())
def test_sharing_takes_no_more_adders_than_the_digits(matrix: ConstantMatrix) -> None:
    sums = sum(isinstance(node, Sum) for node in matrix.graph.nodes)
    # These are the digits of a row and of its constant.
    alone = sum(sum(len(signed_digits(w)) for w in row) for row in matrix.weights)
    assert sums <= alone


def test_a_graph_is_the_same_every_time() -> None:
    rng = np.random.default_rng(1)
    weights = tuple(tuple(map(int, row)) for row in rng.integers(-4000, 4000, (5, 3)))
    matrix = ConstantMatrix(SAMPLES, WIDE, weights, (0, 1, -2, 3, -400), 6, 1, 4)
    first = matrix.graph
    shared.cache_clear()
    assert matrix.graph == first


def test_three_times_and_nine_times_share_an_adder() -> None:
    matrix = ConstantMatrix(SAMPLES, WIDE, ((5, 0), (5, 1), (40, 8)), (0, 0, 0), 0, 0, 4)
    # The adders are 5 x and 5 x + z. The eightfold is a shift by wires.
    assert sum(isinstance(node, Sum) for node in matrix.graph.nodes) == 2


def test_results_saturate() -> None:
    matrix = ConstantMatrix(SAMPLES, Fix(4, 5), ((3, -2),), (0,), 2, 2, 4)
    frames = some_frames(matrix)
    expected = np.clip(products(matrix, frames) >> 2, -8, 7)
    assert (matrix.process(frames) == expected).all()
    assert {-8, 7} <= set(matrix.process(frames).ravel().tolist())
    assert all(not border.unreachable for border in matrix.borders)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"weights": ((1, 2), (3,))}, r"rows of \[2, 1\] weights"),
        ({"biases": (1,)}, "got 1 biases"),
        ({"guard": -1}, "got guard=-1, expected 0 or more"),
        ({"adders_per_clock": 0}, "got adders_per_clock=0, expected 1 or more"),
        ({"biases": (1 << 40, 0)}, "biases"),
    ],
)
def test_what_it_cannot_be_is_refused(changed: dict[str, object], message: str) -> None:
    matrix = ConstantMatrix(SAMPLES, WIDE, ((1, 2), (3, 4)), (0, 0), 4, 2, 4)
    with pytest.raises(InputError, match=message):
        replace(matrix, **changed)
