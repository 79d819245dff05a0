"""The formats of the engine. They are the same for every scene, so the hardware is too."""

from golden.numbers.fixed import Fix
from golden.numbers.precision import EXACT, SIGNAL

# The width of both inputs of one multiplier. The binary point of a weight follows from those of its
# operand and of the sum that it belongs to.
WIDTH = 18
PRODUCT_WIDTH = 2 * WIDTH
# A word of the operand memory, whose binary point depends on what it is.
WORD = Fix(WIDTH, 0)
# Bits of a word of a program.
WORD_WIDTH = 36
# A sample is shifted left in the operand memory, so that weights of layer 1 reach 32.
SAMPLE = Fix(WIDTH, 16)
SAMPLE_SHIFT = SAMPLE.frac - SIGNAL.frac
# The format of a hidden sum q, which is the input of tanh.
HIDDEN = EXACT.hidden_fmt
# The format of tanh and of an output in the operand memory. An output leaves the engine without its
# lowest bits.
RESULT = Fix(WIDTH, 17)
OUTPUT_SHIFT = RESULT.frac - SIGNAL.frac
# The number of fraction bits that are dropped when a sum becomes a word.
DROPPED = 14
# The format of the number one, which is the operand of a bias.
ONE = Fix(WIDTH, DROPPED)


def coeff_frac(result: Fix, operand: Fix) -> int:
    """Fraction bits of a weight between an operand and the word that its sum becomes."""
    return result.frac + DROPPED - operand.frac
