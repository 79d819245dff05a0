"""Where an engine that learns keeps its words, and where a word of its program has its fields."""

from dataclasses import dataclass
from functools import cached_property

from golden.engine.formats import WIDTH
from golden.input_error import InputError

# The fields of a step: the clock of the pipeline in which each is used, and its lowest bit and its
# number of bits in a word of 36 bits. A word of the table holds an intercept, and a slope below it.
#
# product: The coefficient is a second word, whose address is in the field of the weight.
# output: With ``store`` the word leaves the engine. Without it, the next results are stored at the
#     address in the field of the weight.
FIELDS = {
    "weight": ("operand", (0, WIDTH)),
    "source": ("address", (18, 10)),
    "kind": ("operand", (28, 2)),
    "product": ("operand", (30, 1)),
    "first": ("start", (31, 1)),
    "first_of_output": ("start", (32, 1)),
    "store": ("mark", (33, 1)),
    "output": ("mark", (34, 1)),
    "end": ("mark", (35, 1)),
}
_MOST_WIDTH = FIELDS["source"][1][1]


def bits_for(count: int) -> int:
    """The bits of an address of so many words."""
    return (count - 1).bit_length()


@dataclass(frozen=True)
class Places:
    """The addresses of the operand memory; the program holds them.

    ============  ================================================================================
    address       what is there
    ============  ================================================================================
    00 ...        words that a frame or an equation computes, from 0 on; at the end the samples of
                  the last frame, and known outputs as they come in
    01 b ... 1 k  theta, twice; b is the bank, and k counts up to the last address
    1 p k         placement p: its samples, and behind them its known outputs
    ============  ================================================================================

    The program has 1 for every bit of b, and 0 for every bit of p. The hardware puts the bank and
    the number of the placement there.

    scratch: The most words that a frame or an equation computes, theta aside.
    least: The least bits of an address.
    """

    sensors: int
    outputs: int
    scratch: int
    least: int

    def __post_init__(self) -> None:
        if self.addr_width > _MOST_WIDTH:
            raise InputError(
                f"hardware.learning: got {self.scratch} words that an equation computes, expected "
                f"{(1 << (_MOST_WIDTH - 2)) - (1 << self.sample_width) - (1 << self.target_width)} "
                "at most"
            )

    @cached_property
    def sample_width(self) -> int:
        """Bits of the number of a sample; the last number is for a sample that breaks a frame."""
        return bits_for(self.sensors + 1)

    @cached_property
    def target_width(self) -> int:
        """Bits of the number of a word that comes in, a known output or an element of theta."""
        return bits_for(max(self.outputs, self.unknowns) + 1)

    @cached_property
    def placement_width(self) -> int:
        """Bits of the place of a word within a placement."""
        return bits_for(self.sensors + self.outputs)

    @property
    def unknowns(self) -> int:
        return 2 * self.sensors

    @cached_property
    def addr_width(self) -> int:
        """Bits of an address."""
        incoming = (1 << self.sample_width) + (1 << self.target_width)
        quarter = max(
            bits_for(self.scratch + incoming), bits_for(self.unknowns) + 1, self.placement_width
        )
        return max(self.least, quarter + 2)

    @cached_property
    def samples(self) -> int:
        """The address of the first sample, of which the lowest bits are 0."""
        return self.targets - (1 << self.sample_width)

    @cached_property
    def targets(self) -> int:
        """The address of the first known output, as it comes in; its number has more bits."""
        return (1 << (self.addr_width - 2)) - (1 << self.target_width)

    @property
    def theta(self) -> int:
        """The address of the first element of theta, in the program."""
        return (1 << (self.addr_width - 1)) - self.unknowns

    @cached_property
    def bank_bit(self) -> int:
        """The number of the bit of an address that says in which bank theta is."""
        return self.addr_width - 3

    @cached_property
    def placement(self) -> int:
        """The address of the first word of placement 0."""
        return 1 << (self.addr_width - 1)

    @cached_property
    def number_width(self) -> int:
        """Bits of the number of a placement."""
        return self.addr_width - 1 - self.placement_width
