"""Compares graphs of shifted adds with whole numbers, and truncation with its bounds."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from golden.input_error import InputError
from golden.layers import kept_graph
from golden.layers.constant_matrix import ConstantMatrix, Finish
from golden.layers.sharing import shared
from golden.layers.shift_add import Sum
from golden.numbers.fixed import Fix
from golden.numbers.signed_digits import signed_digits
from tactus.core.store import VARIABLE

pytestmark = pytest.mark.usefixtures("few_runs")

SAMPLES = Fix(6, 5)
WIDE = Fix(40, 5)
WEIGHT = st.integers(-(1 << 11), 1 << 11)


@pytest.fixture
def own_store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty store."""
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    return tmp_path


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
        adder_operands=draw(st.sampled_from([2, 3])),
    )


def products(matrix: ConstantMatrix, frames: np.ndarray) -> np.ndarray:
    """The exact sums, in Python's integers."""
    return frames.astype(object) @ np.array(matrix.weights, dtype=object).T + np.array(
        matrix.biases, dtype=object
    )


def some_frames(matrix: ConstantMatrix) -> np.ndarray:
    """Frames for the ends of each sum, and random frames."""
    fmt, signs = matrix.in_fmt, np.array(matrix.weights) < 0
    ends = np.concatenate([np.where(one, fmt.low, fmt.high) for one in (signs, ~signs)])
    random = np.random.default_rng(3).integers(fmt.low, fmt.high + 1, (40, matrix.inputs))
    return np.concatenate([ends, random])


def test_a_graph_of_a_large_matrix_is_kept(own_store: Path, monkeypatch) -> None:
    weights = tuple(tuple(4 * i + j + 1 for j in range(4)) for i in range(8))
    large = ConstantMatrix(SAMPLES, WIDE, weights, (0,) * 8, 6, 1, 4)
    assert sum(map(len, weights)) == kept_graph.LEAST_WEIGHTS
    first = searched(large, 0).graph
    assert len(list(own_store.rglob("*.json"))) == 1
    fewer = replace(large, weights=weights[:-1], biases=(0,) * 7)
    assert fewer.graph
    assert len(list(own_store.rglob("*.json"))) == 1
    with monkeypatch.context() as patch:
        patch.setattr(kept_graph, "shared", pytest.fail)
        assert replace(large).graph == first


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
def test_sharing_takes_no_more_adders_than_the_digits(matrix: ConstantMatrix) -> None:
    sums = sum(isinstance(node, Sum) for node in matrix.graph.nodes)
    # These are the digits of a row and of its constant.
    alone = sum(sum(len(signed_digits(w)) for w in row) for row in matrix.weights)
    assert sums <= alone


def searched(matrix: ConstantMatrix, runs: int) -> ConstantMatrix:
    """The matrix with a graph of so many runs, which is found anew."""
    shared.cache_clear()
    return replace(matrix, search_runs=runs)


def test_results_saturate() -> None:
    matrix = ConstantMatrix(SAMPLES, Fix(4, 5), ((3, -2),), (0,), 2, 2, 4)
    frames = some_frames(matrix)
    expected = np.clip(products(matrix, frames) >> 2, -8, 7)
    assert (matrix.process(frames) == expected).all()
    assert {-8, 7} <= set(matrix.process(frames).ravel().tolist())
    rectified = replace(matrix, finishes=(Finish(rectified=True),))
    assert (matrix.result_ends, rectified.result_ends) == (((-8, 7),), ((0, 7),))


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"weights": ((1, 2), (3,))}, r"rows of \[2, 1\] weights"),
        ({"adder_operands": 4}, "got adder_operands=4, expected 2 or 3"),
        ({"in_ends": ((0, 1), (3, 2))}, r"got in_ends \(3, 2\), expected codes of Fix\(6,5\)"),
        ({"weights": ((1, 2), (3, 1 << 60))}, "got sums of 67 bits, expected 62 at most"),
    ],
)
def test_what_it_cannot_be_is_refused(changed: dict[str, object], message: str) -> None:
    matrix = ConstantMatrix(SAMPLES, WIDE, ((1, 2), (3, 4)), (0, 0), 4, 2, 4)
    with pytest.raises(InputError, match=message):
        replace(matrix, **changed)
