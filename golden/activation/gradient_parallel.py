"""The Gradient activation as first drawn: tanh by segments, with a multiplier for each."""

from collections import Counter
from dataclasses import dataclass
from functools import partial

import numpy as np

from golden.activation.activation_block import COMPARATORS, MULTIPLIERS
from golden.activation.gradient import Gradient, gradient_for
from golden.activation.scheme import Scheme
from golden.activation.segments import UPPER, gradient_real
from golden.common.block import Block
from golden.numbers.fixed import Codes


@dataclass(frozen=True)
class GradientParallel(Gradient):
    """r = tanh(Q qbar) by segments that compute side by side (thesis 4.5.2.3.1, Figure 4.16).

    Each segment has its own gradient operation sub-unit, which gives 0 outside its range, and the
    outputs of all sub-units are added. Parameters, error and results are those of ``Gradient``.
    """

    block = "gradient_parallel"
    section = "4.5.2.3.1"

    def parts(self) -> tuple[Block, ...]:
        return self.abs_unit, self.comparator_bank, self.grad_eqn, self.sign_retriever

    @property
    def saturates(self) -> bool:
        """Whether the neuron exceeds the last segment, where nothing is left to multiply."""
        return len(self.table.thresholds) == len(UPPER)

    @property
    def segments(self) -> tuple[tuple[int, int], ...]:
        """Gradient and intercept of each segment that has a sub-unit."""
        rows = zip(self.table.coeffs, self.table.intercepts, strict=True)
        return tuple(rows)[: -1 if self.saturates else None]

    def parts_left_out(self) -> Counter[str]:
        comparators = len(UPPER) - len(self.table.thresholds)
        return +Counter({COMPARATORS: comparators, MULTIPLIERS: len(UPPER) - len(self.segments)})

    def compute(self, data: Codes) -> Codes:
        mag, negative = self.abs_unit.process(data)
        addr = self.comparator_bank.process(mag)
        total = np.where(addr == len(self.segments), self.out_fmt.high, 0)
        for n, (coeff, intercept) in enumerate(self.segments):
            inside = addr == n
            total += self.grad_eqn.process(mag, inside * coeff, inside * intercept)
        return self.sign_retriever.process(total, negative)


SCHEME = Scheme(gradient_real, partial(gradient_for, kind=GradientParallel))
