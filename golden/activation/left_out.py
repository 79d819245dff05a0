"""Parts that an activation does not have because its neuron never reaches them."""

from collections import Counter
from functools import singledispatch

from golden.activation.activation_block import ActivationBlock
from golden.activation.bipartite import Bipartite
from golden.activation.bipartite_table import MAGNITUDE_WIDTH
from golden.activation.gradient import Gradient
from golden.activation.gradient_parallel import GradientParallel
from golden.activation.lut import DEPTH, Lut
from golden.activation.pade import Pade
from golden.activation.polynomial import UPPER as POLYNOMIAL_UPPER
from golden.activation.polynomial import Polynomial
from golden.activation.precise import Precise
from golden.activation.segments import UPPER

COMPARATORS = "comparators of segments no neuron reaches"
MULTIPLIERS = "multipliers of segments no neuron reaches"
ROM_WORDS = "ROM words of segments no neuron reaches"
TABLE_WORDS = "table words that no neuron reaches"


@singledispatch
def left_out(_: ActivationBlock) -> Counter[str]:
    """How many parts of each kind the block lacks because the neuron cannot need them."""
    return Counter()


@left_out.register
def _(block: Bipartite) -> Counter[str]:
    reached = block.words_within(min(block.reach_width, MAGNITUDE_WIDTH))
    return +Counter({TABLE_WORDS: block.words_within(MAGNITUDE_WIDTH) - reached})


@left_out.register
def _(block: Gradient) -> Counter[str]:
    comparators = len(UPPER) - len(block.table.thresholds)
    # The word of what saturates comes with the last comparator.
    words = 2 * (len(UPPER) + 1 - len(block.table.coeffs)) if comparators else 0
    return +Counter({COMPARATORS: comparators, ROM_WORDS: words})


@left_out.register
def _(block: GradientParallel) -> Counter[str]:
    comparators = len(UPPER) - len(block.table.thresholds)
    return +Counter({COMPARATORS: comparators, MULTIPLIERS: len(UPPER) - len(block.segments)})


@left_out.register
def _(block: Lut) -> Counter[str]:
    words, comparators = DEPTH - len(block.words), 1 - len(block.thresholds)
    return +Counter({TABLE_WORDS: words, COMPARATORS: comparators})


@left_out.register
def _(block: Pade) -> Counter[str]:
    return +Counter({COMPARATORS: 1 - len(block.thresholds)})


@left_out.register
def _(block: Polynomial) -> Counter[str]:
    comparators = len(POLYNOMIAL_UPPER) - len(block.thresholds)
    words = 3 * (len(POLYNOMIAL_UPPER) - len(block.coeffs))
    return +Counter({COMPARATORS: comparators, ROM_WORDS: words})


@left_out.register
def _(block: Precise) -> Counter[str]:
    return +Counter({ROM_WORDS: len(block.whole.intercepts) - block.words})
