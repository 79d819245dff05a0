"""What every activation has in common, so that a network can take any of them."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

from numpy.typing import ArrayLike

from golden.block import Block
from golden.fixed import Codes, Fix


@dataclass(frozen=True)
class ActivationBlock(Block):
    """One result a clock: from q, or q divided by Q, to r.

    Parameters
    ----------
    in_fmt, out_fmt : Fix
        Formats of input and result.
    """

    area = "activation"
    in_fmt: Fix
    out_fmt: Fix

    def process(self, data: ArrayLike) -> Codes:
        """Activation codes in ``out_fmt``, the shape of ``data``."""
        raise NotImplementedError

    def left_out(self) -> Counter[str]:
        """How many of what the neuron cannot need and the block therefore lacks."""
        return Counter()
