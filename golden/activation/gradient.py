"""The modified Gradient activation: computes tanh by segments with one multiplier."""

from collections import Counter
from dataclasses import dataclass

from golden.activation.activation_block import COMPARATORS, ROM_WORDS, OddActivation
from golden.activation.comparator_bank import ComparatorBank
from golden.activation.g_memory import GMemory
from golden.activation.grad_eqn import GradEqn
from golden.activation.i_memory import IMemory
from golden.activation.scheme import Scheme
from golden.activation.segments import UPPER, SegmentTable, gradient_real, segment_table
from golden.common.block import Block
from golden.numbers.fixed import Codes, Rounding
from golden.numbers.precision import SIGNAL, Precision


@dataclass(frozen=True)
class Gradient(OddActivation):
    """r = tanh(Q qbar), approximated by straight segments (thesis section 5.4.3, Figure 5.10).

    table: Constants of the segments that the neuron can reach.
    intercept_width, intercept_frac: Format of the intercept words, unsigned.
    rounding: How GRAD_EQN drops the last bits.

    A magnitude beyond the reach for which the table was made falls into the last segment that is
    kept, where the result may wrap; the neuron cannot produce it.
    """

    block = "gradient"
    section = "5.4.3"
    table: SegmentTable
    intercept_width: int
    intercept_frac: int
    rounding: Rounding

    @property
    def comparator_bank(self) -> ComparatorBank:
        return ComparatorBank(self.abs_unit.mag_width, self.table.thresholds, variant=self.variant)

    @property
    def g_memory(self) -> GMemory:
        table = self.table
        return GMemory(table.coeffs, table.coeff_width, table.coeff_frac, variant=self.variant)

    @property
    def i_memory(self) -> IMemory:
        return IMemory(
            self.table.intercepts, self.intercept_width, self.intercept_frac, variant=self.variant
        )

    @property
    def grad_eqn(self) -> GradEqn:
        return GradEqn(
            self.abs_unit.mag_width,
            self.in_fmt.frac,
            self.table.coeff_width,
            self.table.coeff_frac,
            self.intercept_width,
            self.intercept_frac,
            self.out_fmt,
            self.rounding,
            variant=self.variant,
        )

    @property
    def latency(self) -> int:
        return sum(part.latency for part in self.parts())

    def parts(self) -> tuple[Block, ...]:
        return (
            self.abs_unit,
            self.comparator_bank,
            self.g_memory,
            self.i_memory,
            self.grad_eqn,
            self.sign_retriever,
        )

    def parts_left_out(self) -> Counter[str]:
        comparators = len(UPPER) - len(self.table.thresholds)
        # The word of what saturates comes with the last comparator.
        words = 2 * (len(UPPER) + 1 - len(self.table.coeffs)) if comparators else 0
        return +Counter({COMPARATORS: comparators, ROM_WORDS: words})

    @property
    def marks(self) -> tuple[int, ...]:
        return tuple(self.table.thresholds)

    def compute(self, data: Codes) -> Codes:
        mag, negative = self.abs_unit.process(data)
        addr = self.comparator_bank.process(mag)
        result = self.grad_eqn.process(
            mag, self.g_memory.process(addr), self.i_memory.process(addr)
        )
        return self.sign_retriever.process(result, negative)


def gradient_for(
    precision: Precision, factor: int, reach: int, kind: type[Gradient] = Gradient
) -> Gradient:
    """The Gradient activation for a neuron normalised by ``factor`` with magnitudes to ``reach``.

    ``kind`` is the block: ``Gradient`` with one multiplier, or ``GradientParallel``.
    """
    table = segment_table(precision, factor, reach)
    return kind(
        precision.hidden_fmt,
        SIGNAL,
        table,
        precision.intercept_frac,
        precision.intercept_frac,
        precision.rounding,
        variant=f"q{factor}c{len(table.thresholds)}",
    )


SCHEME = Scheme(gradient_real, gradient_for)
