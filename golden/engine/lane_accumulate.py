"""lane_accumulate: selects the operand of a lane, multiplies it and adds the products up."""

from dataclasses import dataclass
from typing import Self

from golden.common.port import CLOCK, Port, Unsigned, group, input_port, output_port
from golden.engine.accumulator import Accumulator
from golden.engine.formats import WIDTH, WORD
from golden.engine.lane_groups import partners
from golden.engine.lane_program import FIELDS
from golden.numbers.fixed import Fix


@dataclass(frozen=True)
class LaneAccumulate(Accumulator):
    """acc = operand x coefficient + (acc, or a start), or acc + the sum of another lane.

    segment_width: Bits of a hidden sum within a segment; 0 where there is no table.
    partners: The number of lanes whose sums it adds.
    leads: Whether it is the first lane, with which a sum of all lanes starts.
    """

    block = "lane_accumulate"
    part_of = "engine"
    latency = 4
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
