"""Records of coverage exist for every block, and borders are reached."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shared import Shared, copied_job

from golden.activation.abs_unit import AbsUnit
from golden.common.block import Block
from golden.common.border import Border, State
from golden.common.port import Unsigned, input_port, output_port
from golden.layers.closest import closest
from golden.networks.parallel import Neuron
from golden.numbers.fixed import Fix, Rounding, cut
from tactus.verify.benches.runner import run_job
from tactus.verify.sign_off.coverage import named_by
from tb.common.coverage import Coverage, add, missing

pytestmark = pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")


def test_another_border_is_another_source(shared: Shared, monkeypatch) -> None:
    job = shared.subject("abs_unit")
    before = named_by(job.twin)
    monkeypatch.setattr(AbsUnit, "borders", property(lambda _: (Border("another", "code", 3),)))
    assert named_by(job.twin) != before


class Counter(Block):
    """A block with one border, one state and ports of each kind."""

    block = "counter"

    @property
    def borders(self) -> tuple[Border, ...]:
        return (
            Border("full", "count", 5),
            Border("over", "count", 50, unreachable="it stops at 7"),
        )

    @property
    def states(self) -> tuple[State, ...]:
        return (State("count", range(3)),)

    @property
    def ports(self):
        return (input_port("in_valid", ""), output_port("addr", "", Unsigned(2, last=2)))

    @property
    def unreachable(self) -> dict[str, str]:
        return {"addr=1": "it is skipped"}


def test_what_is_not_met_is_named() -> None:
    coverage = Coverage(Counter())
    coverage.meet("count", np.array([4, 4, 6]))
    coverage.visit(State("count", range(3)), np.array([0, 2, 2, 9]))
    coverage.count_port("in_valid", ["1", "1", "X"])
    coverage.count_port("addr", ["00", "11", "UU"])
    assert missing(Counter(), coverage.counts) == [
        "border full: nothing at 5",
        "state count: never 1",
        "port in_valid: never 0",
        "port addr: never 2",
    ]
    more = Coverage(Counter())
    more.meet("count", np.array([5]))
    more.visit(State("count", range(3)), np.array([1]))
    more.count_port("in_valid", ["0"])
    more.count_port("addr", ["10"])
    add(coverage.counts, more.counts)
    assert missing(Counter(), coverage.counts) == []
    assert coverage.counts["borders"]["full"] == {"below": 2, "from": 1}
    assert coverage.counts["ports"]["addr"] == {"0": 1, "1": 0, "2": 1}


def test_a_border_that_is_not_met_fails_the_bench(shared: Shared, tmp_path, monkeypatch) -> None:
    """The twin names one more border than the bench reaches."""
    block = shared.subject("abs_unit")
    known = AbsUnit.borders.fget
    more = property(lambda unit: (*known(unit), Border("another", "code", 10**6)))
    monkeypatch.setattr(AbsUnit, "borders", more)
    outcome = run_job(copied_job(block, tmp_path))
    assert not outcome.passed
    assert (
        outcome.complaint()
        == f"Error: {block.entity}: not driven: border another: nothing at 999999"
    )


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


def test_a_sum_saturates_from_its_border_on() -> None:
    neuron = Neuron(SMALL, Fix(6, 3), SMALL, 0, (9, -11, 7), 3)
    low, high = neuron.ends
    kept = cut(np.array([low - 1, low, high - 1, high]), neuron.out_shift, Rounding.ROUND)
    assert kept.tolist() == [SMALL.low - 1, SMALL.low, SMALL.high, SMALL.high + 1]
    below, above = neuron.borders_of("sum", np.array(neuron.weights), neuron.bias)
    assert (below.at, above.at) == (low, high)
    assert not below.unreachable
    assert not above.unreachable
