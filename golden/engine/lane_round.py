"""lane_round: the sum of a lane, or what the first lane stores, becomes a word."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.block import Block
from golden.engine.formats import DROPPED, SAMPLE_SHIFT
from golden.engine.operand_memory import WORD
from golden.fixed import Codes, Fix
from golden.port import CLOCK, Port, input_port, output_port
from golden.precision import SIGNAL


@dataclass(frozen=True)
class LaneRound(Block):
    """The lane's own sum, rounded and saturated; otherwise a sample, or the word of the first lane.

    Parameters
    ----------
    acc_width : int
        Bits of the sum.
    rectifies : bool
        Whether there is a port that asks for 0 in the place of what is below it.
    leads : bool
        Whether it is that of the first lane, which takes samples and gives the other lanes its
        word.

    Notes
    -----
    Half a unit has been added to the sum before, so dropping bits rounds half up. The word of the
    first lane reaches the others in the clock before it is there, without its last step: where
    ``next_low`` is high, the lowest 17 bits of that word become 0.
    """

    block = "lane_round"
    area = "engine"
    acc_width: int
    rectifies: bool = False
    leads: bool = True

    @property
    def ports(self) -> tuple[Port, ...]:
        if self.leads:
            given: tuple[Port, ...] = (
                input_port("sample", "sample x, stored without `own`", SIGNAL),
            )
            passed: tuple[Port, ...] = (
                output_port("next_word", "the word of the next clock, without its zeros", WORD),
                output_port("next_low", "the lowest 17 bits of the next word are 0"),
            )
        else:
            given = (
                input_port("other", "`next_word` of the first lane, stored without `own`", WORD),
                input_port("other_low", "`next_low` of the first lane"),
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

    @property
    def latency(self) -> int:
        return 1

    def process(
        self, own: ArrayLike, acc: ArrayLike, other: ArrayLike, relu: ArrayLike = 0
    ) -> Codes:
        """The word of each sum, or of each sample or word of the first lane."""
        kept = np.asarray(acc, dtype=np.int64) >> DROPPED
        words = np.clip(kept, np.where(relu, 0, WORD.low), WORD.high)
        given = np.asarray(other, dtype=np.int64)
        return np.where(own, words, given << SAMPLE_SHIFT if self.leads else given)
