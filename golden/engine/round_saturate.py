"""round_saturate: turns a sum, or a sample, into a word of the operand memory."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.border import Border
from golden.common.port import CLOCK, Port, input_port, output_port
from golden.engine.finish import word_of
from golden.engine.formats import DROPPED, SAMPLE_SHIFT
from golden.engine.operand_memory import WORD
from golden.numbers.fixed import Codes, Fix
from golden.numbers.precision import SIGNAL


@dataclass(frozen=True)
class RoundSaturate(Block):
    """The sum, rounded and saturated; while no frame is computed, the sample instead.

    acc_width: Bits of the sum.
    rectifies: Whether the block has a ReLU input, which replaces results below 0 by 0.
    cut: Where it does, so many of the lowest bits of the word become 0.
    even: Where bits are cut, a sum half way between two words becomes the even one.

    Half a unit has been added to the sum before, so dropping bits rounds half up.
    """

    block = "round_saturate"
    area = "engine"
    acc_width: int
    rectifies: bool = False
    cut: int = 0
    even: bool = False

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            CLOCK,
            input_port("run", "a frame is computed"),
            input_port("acc", "the sum", Fix(self.acc_width, 0)),
            input_port("sample", "sample x", SIGNAL),
            output_port("word", "word for the operand memory, one clock later", WORD),
            *self.relu_ports,
        )

    @property
    def relu_ports(self) -> tuple[Port, ...]:
        """What asks for 0 in the place of what is below it; none without ReLU."""
        return (input_port("relu", "a sum below 0 becomes 0"),) if self.rectifies else ()

    @property
    def latency(self) -> int:
        return 1

    @property
    def borders(self) -> tuple[Border, ...]:
        return (
            Border("saturates below", "sum", WORD.low << DROPPED),
            Border("saturates above", "sum", (WORD.high + 1) << DROPPED),
        )

    def process(
        self, run: ArrayLike, acc: ArrayLike, sample: ArrayLike, relu: ArrayLike = 0
    ) -> Codes:
        """The word of each sum or sample."""
        kept = word_of(acc, relu, self.cut, self.even)
        moved = SIGNAL.check(sample, f"{self.entity} sample") << SAMPLE_SHIFT
        return np.where(run, kept, moved)
