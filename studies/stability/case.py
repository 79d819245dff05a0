"""One case of the table, and the functions that compute and judge its figure."""

import itertools
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.input_error import InputError
from golden.networks.arrangement import seen
from golden.networks.constants import quantised
from golden.networks.design import Design
from golden.networks.network import Network
from golden.networks.oracle import designs_in, error_bounds, exact
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL, Precision
from golden.trained.dense import DenseNetwork

LOW, HIGH = SIGNAL.low, SIGNAL.high
EQUAL = "equal exact integers"
BOUNDED = "err by no more than rounding can cause"


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


def combinations(inputs: int) -> Codes:
    """Every frame whose samples are at a rail or 0."""
    return np.array(list(itertools.product((LOW, 0, HIGH), repeat=inputs)))


def exact_network(design: Network, arrangement: str, frames: Codes) -> Codes:
    """The output codes, shape (frames, outputs), in integers of unlimited width.

    frames, shape (frames, inputs): The sample codes.
    arrangement: The arrangement of the networks in ``design``.
    """
    found: list[Codes] = []
    for part in designs_in(design):
        found.append(exact(part, seen(arrangement, frames, found)))
    return np.concatenate(found, axis=1)


def real_error(
    mlp: DenseNetwork,
    precision: Precision,
    network: Design,
    frames: Codes,
    found: Codes,
    sensors: int,
) -> list[tuple[float, float]]:
    """The largest error over the frames, and its bound, for each output in units of 2**-13.

    The reference uses tanh and the unrounded weights. In it, q saturates to the range of its
    format, and y to that of the signals.

    network: The bit-true network.
    frames, found: The samples and the results.
    sensors: How many inputs are samples. The inputs after them are outputs of earlier networks.
    """
    first, second = mlp.layers
    factors = quantised(first, precision, "layer 1 weights").factors
    hidden = precision.hidden_fmt
    bounds = error_bounds(network, mlp, precision, sensors)
    ends = np.multiply.outer(hidden.to_real([hidden.low, hidden.high]), factors)
    q = np.clip(first.sums(SIGNAL.to_real(frames)), *ends)
    y = np.clip(second.sums(np.tanh(q)), *SIGNAL.to_real([LOW, HIGH]))
    errors = np.abs(SIGNAL.to_real(found) - y).max(axis=0)
    return [
        (2**SIGNAL.frac * float(error), 2**SIGNAL.frac * float(bound))
        for error, bound in zip(errors, bounds, strict=True)
    ]
