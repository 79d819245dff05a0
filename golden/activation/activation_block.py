"""What every activation has in common, so that a network can take any of them."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from golden.block import Block
from golden.fixed import Codes, Fix
from golden.port import CLOCKED, Port, given, taken


@dataclass(frozen=True)
class ActivationBlock(Block):
    """From q, or q divided by Q, to r: one result every ``interval`` clocks.

    A subclass computes in ``compute``. Its hardware keeps a result on ``out_data`` at least until
    the input changes, because a folded network reads it more than once.

    Parameters
    ----------
    in_fmt, out_fmt : Fix
        Formats of input and result.
    """

    area = "activation"
    in_fmt: Fix
    out_fmt: Fix

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            taken("in_valid", "`in_data` holds a code"),
            taken("in_data", "q, or q / Q where sums are normalised", self.in_fmt, "in_fmt"),
            given("out_valid", "`out_data` holds a result"),
            given(
                "out_data", "r, which stays at least as long as the input", self.out_fmt, "out_fmt"
            ),
        )

    def process(self, data: ArrayLike) -> Codes:
        """Activation codes in ``out_fmt``, the shape of ``data``.

        Looked up in the results of ``compute`` for every code of the input, which a neuron of a
        network that runs for long meets many times over.

        Raises
        ------
        ValueError
            For a code outside ``in_fmt``.
        """
        codes = self.in_fmt.check(data, f"{self.block} data")
        return np.take(_results(self), codes).astype(np.int64)

    def compute(self, data: Codes) -> Codes:
        """The same from part to part, as the hardware does it."""
        raise NotImplementedError

    def left_out(self) -> Counter[str]:
        """How many of what the neuron cannot need and the block therefore lacks."""
        return Counter()


@lru_cache(maxsize=256)
def _results(activation: ActivationBlock) -> Codes:
    """The activation of every input code: 0 and up, then the negative ones, which numpy counts
    from the end. In the fewest bytes, so that the tables of a network stay in the cache.
    """
    fmt = activation.in_fmt
    codes = np.concatenate([np.arange(fmt.high + 1), np.arange(fmt.low, 0)])
    return activation.compute(codes).astype(np.min_scalar_type(activation.out_fmt.low))
