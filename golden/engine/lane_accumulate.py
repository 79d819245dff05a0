"""lane_accumulate: selects the operand of a lane, multiplies it and adds the products up."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from golden.common.border import Border
from golden.common.port import CLOCK, Port, Unsigned, group, input_port, output_port
from golden.engine.accumulator import Accumulator
from golden.engine.fields import signed_code
from golden.engine.formats import DROPPED, WIDTH
from golden.engine.lane_groups import partners
from golden.engine.lane_program import FIELDS, start_of
from golden.engine.operand_memory import WORD
from golden.engine.operand_select import OperandSelect
from golden.numbers.fixed import Codes, Fix


@dataclass(frozen=True)
class LaneAccumulate(Accumulator):
    """acc = operand x coefficient + (acc, or a start), or acc + the sum of another lane.

    segment_width: Bits of a hidden sum within a segment; 0 where there is no table.
    partners: The number of lanes whose sums it adds.
    leads: Whether it is the first lane, with which a sum of all lanes starts.
    """

    block = "lane_accumulate"
    segment_width: int
    partners: int
    leads: bool

    @classmethod
    def of_lane(
        cls, acc_width: int, segment_width: int, lane: int, lanes: int, variant: str = ""
    ) -> Self:
        """What one of several lanes has. Lanes that are alike have the same entity."""
        others = len(partners(lane, lanes))
        own = str(others) if lane else f"lead_{others}"
        name = f"{variant}_{own}" if variant else own
        return cls(acc_width, segment_width, others, lane == 0, variant=name)

    @property
    def ports(self) -> tuple[Port, ...]:
        acc = Fix(self.acc_width, 0)
        kinds = "0 the word, 1 one with its sign, 2 its distance from the middle of its segment, "
        gathers: tuple[Port, ...] = ()
        if self.partners:
            gathers = (
                input_port(
                    "gather",
                    "two clocks later than `word`: the sum is added that has the number of the bit",
                    Unsigned(self.partners),
                    "partners",
                ),
                *group(input_port("other", "sum * of another lane", acc), self.partners),
            )
        return (
            CLOCK,
            input_port("word", "word that was read", WORD),
            input_port("kind", f"operand: {kinds}3 one", Unsigned(2)),
            input_port("coeff", "one clock later than `word`: a signed code", Unsigned(WIDTH)),
            input_port(
                "opens",
                "comes with `coeff`: 1 a sum of this lane starts, 2 one of all lanes, 3 one of an "
                "output",
                Unsigned(FIELDS["opens"][1]),
            ),
            *gathers,
            output_port("acc", "the sum, four clocks after `word`", acc),
            output_port("high", "the sum is above every word"),
            output_port("low", "the sum is below every word"),
        )

    @property
    def latency(self) -> int:
        return 4

    @property
    def borders(self) -> tuple[Border, ...]:
        return (
            Border("too low", "sum", WORD.low << DROPPED),
            Border("too high", "sum", (WORD.high + 1) << DROPPED),
            Border("negative", "word", 0),
        )

    def process(
        self,
        word: ArrayLike,
        kind: ArrayLike,
        coeff: ArrayLike,
        opens: ArrayLike,
        gather: ArrayLike = 0,
        others: Sequence[ArrayLike] = (),
    ) -> Codes:
        """The sum after each step. The first step starts a sum.

        All values of an index belong to the same step. The other sums are those before the step. A
        sum that does not fit in its bits wraps; the sums of an assembled program always fit.
        """
        words, kinds = np.asarray(word, dtype=np.int64), np.asarray(kind)
        if self.segment_width:
            operand = OperandSelect(self.segment_width).process(words, kinds)
        else:
            operand = np.where(kinds & 1, 1 << DROPPED, words)
        added = operand * signed_code(np.asarray(coeff, dtype=np.int64))
        for number, other in enumerate(others):
            added = np.where(np.asarray(gather) >> number & 1, other, added)
        acc, found = 0, []
        for value, start in zip(added.tolist(), np.asarray(opens).tolist(), strict=True):
            acc = self.wrapped(value + (start_of(start, int(not self.leads)) if start else acc))
            found.append(acc)
        return np.array(found, dtype=np.int64)


def beyond(acc: ArrayLike) -> tuple[Codes, Codes]:
    """Whether sums are above every word, and below every word."""
    kept = np.asarray(acc, dtype=np.int64) >> DROPPED
    return (kept > WORD.high).astype(np.int64), (kept < WORD.low).astype(np.int64)
