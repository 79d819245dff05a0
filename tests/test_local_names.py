"""Tests that signals are declared in the same order under every version of Python."""

import sys

from tactus.export import myhdl_changes
from tactus.export.myhdl_changes import Caller, forget


def looks() -> tuple[list[str], list[str]]:
    """The names of a function when it is asked twice, as the instances of a block do."""
    zeta, plain, second = 1, 2, 3
    captured = 4
    beta = [captured + item for item in range(2)]
    alpha = [zeta + inner for inner in beta]

    def process() -> int:
        return second + len(alpha)

    frame = sys._getframe()
    first = list(Caller(frame).f_locals)
    before = plain + process()

    def late() -> int:
        return before

    last = list(Caller(frame).f_locals)
    assert late()
    forget([])
    return first, last


def test_plain_names_as_bound_then_those_used_inside_by_alphabet() -> None:
    first, last = looks()
    # A comprehension gets its first iterable as an argument, so beta is not used inside it.
    assert first == ["plain", "beta", "process", "frame", "alpha", "captured", "second", "zeta"]
    assert last == [*first, "first", "late", "before"]


def test_nothing_is_kept_of_a_function_that_has_ended() -> None:
    looks()
    assert not myhdl_changes._seen
