"""lane_round: the sum of a lane, or what the first lane stores, becomes a word."""

from dataclasses import dataclass

from golden.common.block import Block
from golden.common.port import CLOCK, Port, input_port, output_port
from golden.engine.formats import WORD
from golden.numbers.fixed import Fix
from golden.numbers.precision import SIGNAL


@dataclass(frozen=True)
class LaneRound(Block):
    """The lane's own sum, rounded and saturated; otherwise a sample, or the word of the first lane.

    acc_width: Bits of the sum.
    rectifies: Whether the block has a ReLU input, which replaces results below 0 by 0.
    leads: Whether it is that of the first lane, which takes samples and gives the other lanes its
        word.
    cut: With ReLU, so many of the lowest bits of the word become 0.
    even: Where bits are cut, a sum half way between two words becomes the even one.

    Half a unit has been added to the sum before, so dropping bits rounds half up. The word of the
    first lane reaches the others in the clock before it is there, without its last step: where
    ``next_low`` is high, the lowest 17 bits of that word become 0. So do the lowest ``cut`` bits
    with ``next_cut``, and the bit above these with ``next_even``.
    """

    block = "lane_round"
    part_of = "engine"
    area = "engine"
    latency = 1
    acc_width: int
    rectifies: bool = False
    leads: bool = True
    cut: int = 0
    even: bool = False

    @property
    def zeros(self) -> dict[str, int]:
        """What becomes 0 in the register, with a mask of the bits of the word that do not."""
        found = {"low": WORD.low}
        if self.cut:
            found["cut"] = -1 << self.cut
        if self.even:
            found["even"] = ~(1 << self.cut)
        return found

    @property
    def ports(self) -> tuple[Port, ...]:
        texts = {
            "cut": "the bits of the next word below those of a quantiser's code are 0",
            "even": "the lowest bit of the next word's code is 0",
        }
        if self.leads:
            given: tuple[Port, ...] = (
                input_port("sample", "sample x, stored without `own`", SIGNAL),
            )
            passed: tuple[Port, ...] = (
                output_port("next_word", "the word of the next clock, without its zeros", WORD),
                output_port("next_low", "the lowest 17 bits of the next word are 0"),
                *(output_port(f"next_{name}", texts[name]) for name in texts if name in self.zeros),
            )
        else:
            given = (
                input_port("other", "`next_word` of the first lane, stored without `own`", WORD),
                *(
                    input_port(f"other_{name}", f"`next_{name}` of the first lane")
                    for name in self.zeros
                ),
            )
            passed = ()
        relu = (input_port("relu", "a sum below 0 becomes 0"),) if self.rectifies else ()
        return (
            CLOCK,
            input_port("own", "the sum becomes the word"),
            input_port("acc", "the sum", Fix(self.acc_width, 0)),
            input_port("high", "the sum is above every word"),
            input_port("low", "the sum is below every word"),
            *relu,
            *given,
            output_port("word", "word for the operand memory, one clock later", WORD),
            *passed,
        )
