"""One case of the table, and the functions that compute its figure."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.input_error import InputError


@dataclass(frozen=True)
class Row:
    """A case that was run: what must happen, its figure, and the bound of the figure."""

    model: str
    case: str
    must: str
    figure: str
    value: float
    bound: float

    @property
    def holds(self) -> bool:
        """Whether the figure keeps its bound. NaN does not."""
        return bool(self.value <= self.bound)


def largest(*values: ArrayLike) -> float:
    """The largest magnitude, or infinity if a value is not finite, so that no bound holds."""
    together = np.concatenate([np.asarray(v, dtype=np.float64).ravel() for v in values])
    return float(np.abs(together).max()) if np.isfinite(together).all() else math.inf


def worst(errors: ArrayLike, bounds: ArrayLike) -> tuple[float, float]:
    """Of many errors the one that is nearest to its own bound, and this bound."""
    found, most = np.broadcast_arrays(np.abs(errors), bounds)
    if not np.isfinite(found).all():
        return math.inf, float(most.max())
    place = np.unravel_index(np.argmax(found / most), found.shape)
    return float(found[place]), float(most[place])


def accepted(calls: Iterable[Callable[[], object]]) -> int:
    """How many of the calls, which have invalid arguments, do not raise ``InputError``."""
    count = 0
    for call in calls:
        try:
            call()
        except InputError:
            continue
        count += 1
    return count
