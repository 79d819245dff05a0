"""Measures run times for the timed columns of a table."""

import time
from collections.abc import Callable
from typing import ParamSpec, TypeVar

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

# The shortest of a few calls is the time of the work. Longer ones include other work of the
# machine.
CALLS, ENOUGH = 5, 0.05  # calls at most, seconds after which no other begins


def timed(
    work: Callable[Arguments, Result], *args: Arguments.args, **kwargs: Arguments.kwargs
) -> tuple[Result, float]:
    """The result of ``work`` for the arguments, and the shortest of its run times in ms."""
    least, spent = float("inf"), 0.0
    for _ in range(CALLS):
        started = time.perf_counter()
        result = work(*args, **kwargs)
        took = time.perf_counter() - started
        least, spent = min(least, took), spent + took
        if spent > ENOUGH:
            break
    return result, 1e3 * least
