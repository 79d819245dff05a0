"""plane_select: picks the bit of an operand for a pass, and what it does to the sum."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.port import CLOCK, Port, Unsigned, input_port, output_port
from golden.engine.formats import WIDTH
from golden.engine.graph import Kind
from golden.engine.operand_memory import WORD
from golden.engine.replay import CLEAR, SIGN
from golden.numbers.fixed import Codes


@dataclass(frozen=True)
class PlaneSelect(Block):
    """Decides whether a coefficient is added, subtracted or neither.

    segment_width: Bits of q within a segment.

    The number one, with either sign, is read only in its own plane, so its bit is always set there.
    Where nothing is added, ``subtract`` has no effect.
    """

    block = "plane_select"
    area = "engine"
    segment_width: int

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            CLOCK,
            input_port("word", "word that was read", WORD),
            input_port(
                "plane", "one bit of 19 is set; the highest clears the sum", Unsigned(CLEAR + 1)
            ),
            input_port(
                "kind",
                "operand: 0 the word, 1 one with its sign, 2 the distance, 3 one",
                Unsigned(2),
            ),
            output_port("take_weight", "the weight of the program counts; one clock after `word`"),
            output_port("look_up", "the word of the table counts; one clock after `word`"),
            output_port("subtract", "the coefficient is subtracted; one clock after `word`"),
        )

    @property
    def latency(self) -> int:
        return 1

    def process(
        self, word: ArrayLike, plane: ArrayLike, kind: ArrayLike
    ) -> tuple[Codes, Codes, Codes]:
        """``take_weight``, ``look_up`` and ``subtract`` of each word; ``plane`` has one bit set."""
        words, kinds = WORD.check(word, f"{self.entity} word"), np.asarray(kind)
        planes = np.asarray(plane, dtype=np.int64)
        # The highest bit of the distance, inverted, is its sign.
        middle = 1 << (self.segment_width - 1)
        within = 2 * middle - 1
        bit = words & planes & ((1 << WIDTH) - 1) != 0
        distance_bit = (words ^ middle) & planes & within != 0
        take = np.select([kinds == Kind.WORD, kinds == Kind.ONE], [bit, True], False)
        table = np.select(
            [kinds == Kind.INTERCEPT, kinds == Kind.DISTANCE], [True, distance_bit], False
        )
        sign = planes == 1 << SIGN
        subtract = np.select(
            [kinds == Kind.INTERCEPT, kinds == Kind.DISTANCE],
            [sign | (words < 0), sign | (planes == middle)],
            sign,
        )
        return take.astype(np.int64), table.astype(np.int64), subtract.astype(np.int64)
