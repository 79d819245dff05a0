"""exp_interpolator: computes exp(-x) from one word of the memory and the rest of x."""

from dataclasses import dataclass

from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.port import CLOCKED, Port, Unsigned, input_port, output_port
from golden.numbers.fixed import Codes, check_unsigned


@dataclass(frozen=True)
class ExpInterpolator(Block):
    """exp(-x) = word (1 - delta), in which the word of the memory is also the slope.

    The word is exp(-x0) in the middle x0 of an interval, and delta = x - x0. The derivative of
    exp(-x) at x0 is -exp(-x0), the negative of the word, so no second table is needed.

    word_width: Bits of the word, all of them fraction bits, unsigned.
    offset_width: Bits of x below the memory's address.
    frac: Fraction bits of x.

    The factor 1 - delta is exact and unsigned, with ``factor_width`` bits. The product is truncated
    to the word's format. The straight line lies 0 to delta**2 / 2 below exp(-x), at most 2**-15 for
    an interval of 2**-6; truncation adds an error of 1 LSB of the word. The result is below 1.
    """

    block = "exp_interpolator"
    part_of = "load_profile"
    area = "visualisation"
    latency = 2
    word_width: int
    offset_width: int
    frac: int

    @property
    def factor_width(self) -> int:
        """Bits of the unsigned 1 - delta, which is at most slightly more than 1."""
        return self.frac + 1

    @property
    def ports(self) -> tuple[Port, ...]:
        word = Unsigned(self.word_width, self.word_width)
        return (
            *CLOCKED,
            input_port("in_valid", "word and offset are there, for this clock"),
            input_port("in_word", "exp(-x0)", word, "word_width"),
            input_port(
                "in_offset",
                "lower bits of x",
                Unsigned(self.offset_width, self.frac),
                "offset_width",
            ),
            output_port("out_valid", "`out_data` holds a result"),
            output_port("out_data", "exp(-x)", word, "word_width"),
        )

    def process(self, word: ArrayLike, offset: ArrayLike) -> Codes:
        """exp(-x) in the word's format; the arguments are broadcast."""
        w = check_unsigned(word, self.word_width, "exp_interpolator word")
        low = check_unsigned(offset, self.offset_width, "exp_interpolator offset")
        # The factor is 1 - delta, with delta = offset - half an interval.
        factor = (1 << self.frac) + (1 << (self.offset_width - 1)) - low
        return (w * factor) >> self.frac
