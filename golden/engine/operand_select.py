"""operand_select: makes the multiplier's operand from the word that was read."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.port import CLOCK, Unsigned, input_port, output_port
from golden.engine.formats import DROPPED, WORD
from golden.engine.graph import Kind
from golden.numbers.fixed import Codes


@dataclass(frozen=True)
class OperandSelect(Block):
    """Passes one of four: the word, one with the word's sign, the word's distance, or one.

    segment_width: Bits of q within a segment. The distance is that of q from the middle of its
        segment.
    registers: Registers beyond the first, for a table whose word comes later.
    """

    block = "operand_select"
    part_of = "learning_engine"
    area = "engine"
    segment_width: int
    registers: int = 0

    ports = (
        CLOCK,
        input_port("word", "word that was read", WORD),
        input_port(
            "kind",
            "operand: 0 the word, 1 one with its sign, 2 the distance, 3 one",
            Unsigned(2),
        ),
        output_port("operand", "operand, registered", WORD),
    )

    @property
    def latency(self) -> int:
        return 1 + self.registers

    def process(self, word: ArrayLike, kind: ArrayLike) -> Codes:
        """The operand of each word and kind."""
        words, kinds = WORD.check(word, f"{self.entity} word"), np.asarray(kind)
        one = 1 << DROPPED
        span = 1 << self.segment_width
        return np.select(
            [kinds == Kind.WORD, kinds == Kind.INTERCEPT, kinds == Kind.DISTANCE],
            [words, np.where(words < 0, -one, one), (words & (span - 1)) - span // 2],
            one,
        )
