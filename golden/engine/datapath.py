"""The parts of a lane, and those that an engine that learns has in their place."""

from dataclasses import dataclass
from typing import Self

from golden.common.block import Block
from golden.common.port import CLOCK, Port, Unsigned, group, input_port, output_port
from golden.engine.formats import HIDDEN, PRODUCT_WIDTH, WIDTH, WORD
from golden.engine.lane_groups import partners
from golden.engine.lane_program import FIELDS
from golden.numbers.fixed import Fix
from golden.numbers.precision import SIGNAL

_MOST_WIDTH = 48


@dataclass(frozen=True)
class Accumulator(Block):
    """A block that holds a sum of ``acc_width`` bits.

    acc_width: Bits of the sum, 36 or more. The sums of a program that was assembled for this width
        always fit in it.
    """

    area = "engine"
    acc_width: int

    def __post_init__(self) -> None:
        self.check(acc_width=(PRODUCT_WIDTH, _MOST_WIDTH))


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


@dataclass(frozen=True)
class OperandSelect(Block):
    """Passes one of four: the word, one with the word's sign, the word's distance, or one.

    segment_width: Bits of q within a segment. The distance is that of q from the middle of its
        segment.
    """

    block = "operand_select"
    part_of = "learning_engine"
    area = "engine"
    # The word of the table comes as late.
    latency = 2
    segment_width: int

    ports = (
        CLOCK,
        input_port("word", "word that was read", WORD),
        input_port(
            "kind", "operand: 0 the word, 1 one with its sign, 2 the distance, 3 one", Unsigned(2)
        ),
        output_port("operand", "operand, registered", WORD),
    )


@dataclass(frozen=True)
class TableAddress(Block):
    """The high bits of q, complemented where q is negative, limited to the last segment.

    segment_width: Bits of q within a segment.
    segments: Words of the table. The last one serves sums beyond the last segment too.
    """

    block = "table_address"
    part_of = "learning_engine"
    area = "engine"
    latency = 1
    segment_width: int
    segments: int

    @property
    def addr_width(self) -> int:
        return max(1, (self.segments - 1).bit_length())

    @property
    def ports(self) -> tuple[Port, ...]:
        addr = Unsigned(self.addr_width, last=self.segments - 1)
        return (
            CLOCK,
            input_port("q", "a hidden sum", HIDDEN),
            output_port("addr", "segment of q, one clock later", addr),
        )


@dataclass(frozen=True)
class MultiplyAccumulate(Accumulator):
    """acc = operand x coefficient + (acc, or half a unit of the result).

    The coefficient is the bitwise OR of the program's weight and of a word of the table, one of
    which is 0. Products and sums are exact. A sum starts with half a unit of its result, so that
    dropping bits rounds the result half up.
    """

    block = "multiply_accumulate"
    part_of = "learning_engine"
    latency = 4

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            CLOCK,
            input_port("operand", "multiplicand", WORD),
            input_port(
                "weight",
                "weight of the program, or 0 if the table gives the coefficient",
                Unsigned(WIDTH),
            ),
            input_port("take_intercept", "take the intercept of the table, not its slope"),
            input_port("table_word", "intercept and slope, or 0", Unsigned(PRODUCT_WIDTH)),
            input_port("first", "two clocks after an operand: its product starts a sum"),
            input_port("first_of_output", "its product starts the sum of an output"),
            output_port("acc", "the sum, four clocks after the operand", Fix(self.acc_width, 0)),
        )


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
