"""Compares graphs of shifted adds with whole numbers, and truncation with its bounds."""

from collections import Counter
from dataclasses import replace
from itertools import combinations, pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from golden.input_error import InputError
from golden.layers import kept_graph, sharing
from golden.layers.constant_matrix import ConstantMatrix, Finish
from golden.layers.sharing import shared
from golden.layers.shift_add import Operand, Sum
from golden.layers.three_operands import fused, saving_of
from golden.numbers.fixed import Fix
from golden.numbers.signed_digits import signed_digits
from tactus.core.folders import BUILD
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
    ends = [frame for pair in matrix.ends for frame in pair]
    fmt = matrix.in_fmt
    random = np.random.default_rng(3).integers(fmt.low, fmt.high + 1, (40, matrix.inputs))
    return np.concatenate([np.array(ends), random])


def test_a_graph_of_a_large_matrix_is_kept(
    own_store: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
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


def test_what_only_checks_a_scene_keeps_no_graph(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    monkeypatch.chdir(tmp_path)
    weights = tuple(tuple(4 * i + j + 1 for j in range(4)) for i in range(8))
    large = ConstantMatrix(SAMPLES, WIDE, weights, (0,) * 8, 6, 1, 4)
    assert searched(large, 0).graph
    assert list(tmp_path.iterdir()) == []
    BUILD.mkdir()
    assert searched(large, 0).graph
    assert len(list(BUILD.rglob("*.json"))) == 1


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
            assert max(one.node for one in node.operands) < place
            assert graph.steps(place)[0].move == 0
            first, cut = node.operands[0].node, graph.steps(place)[0].cut
            assert graph.passing(place) in (0, graph.beside(place))
            assert graph.passing(place) <= max(0, graph.widths[first] - cut)


@settings(max_examples=30, deadline=None)
@given(matrices())
def test_samples_within_ends_need_no_more_bits(matrix: ConstantMatrix) -> None:
    narrow = replace(matrix, in_ends=tuple((0, 3 + k) for k in range(matrix.inputs)))
    frames = some_frames(matrix) % (4 + np.arange(matrix.inputs))
    for number, (low, high) in zip(
        narrow.graph.numbers(frames.T), narrow.graph.bounds, strict=True
    ):
        assert low <= number.min()
        assert number.max() <= high
    # The search may find another graph for such samples, so the bits are those of the same one.
    same = replace(matrix.graph, ends=narrow.in_ends)
    for less, more in zip(same.widths, matrix.graph.widths, strict=True):
        assert less <= more


@settings(max_examples=30, deadline=None)
@given(
    matrices(),
    st.integers(3, 8),
    st.lists(st.builds(Finish, st.booleans(), st.booleans()), min_size=4, max_size=4),
)
def test_a_finish_rounds_and_rectifies(
    matrix: ConstantMatrix, width: int, finishes: list[Finish]
) -> None:
    """The result in Python's integers: the nearest code, halves up or to even, then clipped."""
    shift = matrix.out_shift + 1
    half = 1 << (shift - 1)
    rounded = replace(
        matrix,
        out_fmt=Fix(width, 0),
        out_shift=shift,
        guard=shift,
        # Sums of about the size of a result, with the half that rounds them.
        weights=tuple(tuple(w >> 4 for w in row) for row in matrix.weights),
        biases=tuple((bias >> 8) + half for bias in matrix.biases),
        finishes=tuple(finishes[: len(matrix.weights)]),
    )
    frames = some_frames(rounded)
    results = rounded.process(frames)
    assert (results == rounded.exact(frames)).all()
    for i, finish in enumerate(rounded.finishes):
        low, high = 0 if finish.rectified else rounded.out_fmt.low, rounded.out_fmt.high
        for total, result in zip(products(rounded, frames)[:, i], results[:, i], strict=True):
            code, rest = divmod(total - half, 2 * half)
            up = rest > half or (rest == half and (not finish.even or code % 2 == 1))
            assert result == max(low, min(high, code + up))


def test_a_matrix_publishes_the_borders_of_a_finish() -> None:
    matrix = ConstantMatrix(
        SAMPLES,
        Fix(4, 5),
        ((3, -2), (3, -2)),
        (2, 2),
        2,
        2,
        4,
        finishes=(Finish(rectified=True), Finish(even=True)),
    )
    assert [border.name for border in matrix.borders] == [
        "result 0 is rectified",
        "result 0 saturates above",
        "result 1 saturates below",
        "result 1 saturates above",
        "result 1 becomes even",
    ]
    assert all(not border.unreachable for border in matrix.borders)
    assert matrix.result_ends == ((0, 7), (-8, 7))
    last = matrix.quantities(matrix.ties(1))["last bit of tie 1"]
    assert set(last.tolist()) == {0, 1}


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


def searched(matrix: ConstantMatrix, runs: int) -> ConstantMatrix:
    """The matrix with a graph of so many runs, which is found anew."""
    shared.cache_clear()
    return replace(matrix, search_runs=runs)


@pytest.mark.usefixtures("own_store")
@settings(
    max_examples=20, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(matrices())
def test_more_runs_never_need_more_bits(matrix: ConstantMatrix) -> None:
    assert searched(matrix, sharing.RUNS).graph == matrix.graph
    found = [matrix, searched(matrix, 4), searched(matrix, 12)]
    for fewer, more in pairwise(found):
        assert more.latency < fewer.latency or more.graph.adder_bits <= fewer.graph.adder_bits
    whole = replace(found[-1], guard=matrix.out_shift)
    frames = some_frames(whole)
    assert (whole.process(frames) == products(whole, frames) >> whole.out_shift).all()


MANY = ConstantMatrix(
    SAMPLES,
    WIDE,
    tuple(tuple(row) for row in np.random.default_rng(1).integers(-4000, 4000, (5, 3)).tolist()),
    (0, 1, -2, 3, -400),
    6,
    1,
    4,
)


@pytest.mark.usefixtures("own_store")
def test_more_runs_find_a_smaller_graph() -> None:
    bits = [searched(MANY, runs).graph.adder_bits for runs in (2, 30)]
    assert bits[1] < bits[0]


def test_a_graph_of_more_runs_is_kept_for_its_matrix_and_settings(
    own_store: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = searched(MANY, 6).graph
    kept = list(own_store.rglob("*.json"))
    assert len(kept) == 1
    with monkeypatch.context() as patch:
        patch.setattr(kept_graph, "shared", pytest.fail)
        assert replace(MANY, search_runs=6).graph == first
    for changed in ({"search_runs": 7}, {"guard": 2}, {"adder_operands": 3}):
        assert searched(replace(MANY, **changed), changed.get("search_runs", 6)).graph
    assert len(list(own_store.rglob("*.json"))) == 4
    # Without the store the same graph is found.
    kept[0].unlink()
    assert searched(MANY, 6).graph == first


@settings(max_examples=30, deadline=None)
@given(matrices())
def test_three_operands_give_the_same_results_with_fewer_bits(matrix: ConstantMatrix) -> None:
    graph = replace(matrix, adder_operands=2).graph
    made = fused(graph)
    frames = some_frames(matrix).T
    before, after = graph.numbers(frames), made.numbers(frames)
    for one, other in zip(graph.rows, made.rows, strict=True):
        assert (before[one.node] == after[other.node]).all()
        assert graph.reaches[one.node] == made.reaches[other.node]
    assert made.adder_bits <= graph.adder_bits
    assert made.depth <= graph.depth
    for node in made.nodes:
        if isinstance(node, Sum):
            assert len(node.operands) in (2, 3)
            assert node.operands[0].shift == 0
            assert any(one.sign > 0 for one in node.operands)


@settings(max_examples=30, deadline=None)
@given(matrices())
def test_no_other_pairs_of_sums_save_more(matrix: ConstantMatrix) -> None:
    """Tries every set of sums that are taken in, in a graph with few of them."""
    graph = replace(matrix, adder_operands=2).graph
    users = Counter(one.node for n in graph.nodes if isinstance(n, Sum) for one in n.operands)
    users.update(row.node for row in graph.rows for _ in range(2))
    pairs = [
        (place, one.node)
        for place, node in enumerate(graph.nodes)
        if isinstance(node, Sum)
        for one in node.operands
        if users[one.node] == 1 and isinstance(graph.nodes[one.node], Sum)
    ]
    assume(len(pairs) <= 10)
    least = min(
        graph.adder_bits - sum(saving_of(graph, *pair) for pair in chosen)
        for count in range(len(pairs) + 1)
        for chosen in combinations(pairs, count)
        if len({place for pair in chosen for place in pair}) == 2 * count
    )
    assert fused(graph).adder_bits == least


def test_bits_that_an_operand_does_not_have_pass_beside_no_adder() -> None:
    """A sample of 6 bits and the same 10 places further left."""
    graph = ConstantMatrix(SAMPLES, WIDE, ((1025,),), (0,), 0, 0, 4).graph
    assert (graph.beside(1), graph.passing(1)) == (10, 0)
    graph = ConstantMatrix(SAMPLES, WIDE, ((65,),), (0,), 0, 0, 4).graph
    assert (graph.beside(1), graph.passing(1)) == (6, 6)


def test_a_sum_of_three_counts_as_one_adder() -> None:
    # 1 + 4 + 16 times a sample.
    matrix = ConstantMatrix(SAMPLES, WIDE, ((21,),), (0,), 0, 0, 1)
    three = replace(matrix, adder_operands=3)
    assert (matrix.graph.depth, three.graph.depth) == (2, 1)
    assert (matrix.latency, three.latency) == (2, 1)
    (node,) = (node for node in three.graph.nodes if isinstance(node, Sum))
    assert node == Sum((Operand(0), Operand(0, 2), Operand(0, 4)))


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
        ({"search_runs": -1}, "got search_runs=-1, expected 0 or more"),
        ({"adders_per_clock": 0}, "got adders_per_clock=0, expected 1 or more"),
        ({"adder_operands": 4}, "got adder_operands=4, expected 2 or 3"),
        ({"finishes": (Finish(),)}, "got 1 finishes, expected 2 or none"),
        ({"in_ends": ((0, 1),)}, "got 1 in_ends, expected 2 or none"),
        ({"in_ends": ((0, 1), (3, 2))}, r"got in_ends \(3, 2\), expected codes of Fix\(6,5\)"),
        ({"in_ends": ((0, 1), (0, 32))}, r"got in_ends \(0, 32\), expected codes of Fix\(6,5\)"),
        ({"weights": ((1, 2), (3, 1 << 60))}, "got sums of 67 bits, expected 62 at most"),
        ({"biases": (1 << 40, 0)}, "biases"),
    ],
)
def test_what_it_cannot_be_is_refused(changed: dict[str, object], message: str) -> None:
    matrix = ConstantMatrix(SAMPLES, WIDE, ((1, 2), (3, 4)), (0, 0), 4, 2, 4)
    with pytest.raises(InputError, match=message):
        replace(matrix, **changed)
