"""Tests the borders that twins publish, and the samples that reach them."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from golden.layers.closest import closest
from golden.layers.neuron import Neuron
from golden.numbers.fixed import Fix, Rounding, cut

SMALL = Fix(4, 3)
CODES = range(SMALL.low, SMALL.high + 1)
WEIGHT = st.integers(-15, 15)


def ends_of(fmt: Fix, weights) -> tuple[tuple[int, int], ...]:
    return ((fmt.low, fmt.high),) * len(weights)


def total(weights: list[int], frame, start: int, shift: int) -> int:
    return start + sum((w * int(x)) >> shift for w, x in zip(weights, frame, strict=True))


@given(
    st.lists(WEIGHT, min_size=1, max_size=2),
    st.integers(-50, 50),
    st.integers(0, 3),
    st.integers(-300, 300),
    st.booleans(),
)
def test_of_two_weights_none_is_closer(weights, start, shift, target, above) -> None:
    sums = [total(weights, frame, start, shift) for frame in product(CODES, repeat=len(weights))]
    side = [s for s in sums if (s >= target if above else s <= target)]
    row = np.array(weights)
    found = closest(ends_of(SMALL, row), row, start, shift, target, above, np.random.default_rng(0))
    if not any(weights):
        return
    if not side:
        assert found is None
    else:
        assert found is not None
        best = min(side) if above else max(side)
        assert total(weights, found, start, shift) == best


@pytest.mark.parametrize("shift", [0, 13])
@pytest.mark.parametrize("above", [False, True])
def test_of_many_weights_the_sum_is_the_target(shift: int, above: bool) -> None:
    rng = np.random.default_rng(1)
    fmt = Fix(14, 13)
    weights = rng.integers(-8191, 8192, 5)
    reach = int((np.abs(weights).sum() * 8191) >> shift)
    for target in (reach // 2, -reach // 3, 17):
        found = closest(ends_of(fmt, weights), weights, 5, shift, target, above, rng)
        assert found is not None
        assert total(weights.tolist(), found, 5, shift) == target


def test_a_sum_saturates_from_its_border_on() -> None:
    neuron = Neuron(SMALL, Fix(6, 3), SMALL, 0, (9, -11, 7), 3)
    low, high = neuron.ends
    kept = cut(np.array([low - 1, low, high - 1, high]), neuron.out_shift, Rounding.ROUND)
    assert kept.tolist() == [SMALL.low - 1, SMALL.low, SMALL.high, SMALL.high + 1]
    below, above = neuron.borders_of("sum", np.array(neuron.weights), neuron.bias)
    assert (below.at, above.at) == (low, high)
    assert not below.unreachable
    assert not above.unreachable
