"""The formats of the engine: the same for every scene, so that its hardware is."""

from __future__ import annotations

from golden.fixed import Fix
from golden.precision import EXACT, SIGNAL

# What one multiplier of 18 bits takes; a weight's binary point follows from those of its operand
# and of the sum that it belongs to.
WIDTH = 18
PRODUCT_WIDTH = 2 * WIDTH
# A sample in the operand memory: moved to the left, so that weights of layer 1 reach 32.
SAMPLE = Fix(WIDTH, 16)
SAMPLE_SHIFT = SAMPLE.frac - SIGNAL.frac
# A hidden sum q, the input of tanh.
HIDDEN = EXACT.hidden_fmt
# tanh and an output in the operand memory; an output leaves without its lowest bits.
RESULT = Fix(WIDTH, 17)
OUTPUT_SHIFT = RESULT.frac - SIGNAL.frac
# Fraction bits that every sum drops when it becomes a word.
DROPPED = 14
# The operand of a bias: the number one.
ONE = Fix(WIDTH, DROPPED)


def coeff_frac(result: Fix, operand: Fix) -> int:
    """Fraction bits of a weight between an operand and the word that its sum becomes."""
    return result.frac + DROPPED - operand.frac
