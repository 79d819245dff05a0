"""round_saturate: turns a sum, or a sample, into a word of the operand memory."""

from dataclasses import dataclass

from golden.common.block import Block
from golden.common.port import CLOCK, Port, input_port, output_port
from golden.engine.formats import WORD
from golden.numbers.fixed import Fix
from golden.numbers.precision import SIGNAL


@dataclass(frozen=True)
class RoundSaturate(Block):
    """The sum, rounded and saturated; while no frame is computed, the sample instead.

    acc_width: Bits of the sum.

    Half a unit has been added to the sum before, so dropping bits rounds half up.
    """

    block = "round_saturate"
    part_of = "learning_engine"
    area = "engine"
    latency = 1
    acc_width: int

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            CLOCK,
            input_port("run", "a frame is computed"),
            input_port("acc", "the sum", Fix(self.acc_width, 0)),
            input_port("sample", "sample x", SIGNAL),
            output_port("word", "word for the operand memory, one clock later", WORD),
        )
