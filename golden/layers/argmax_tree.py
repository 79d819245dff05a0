"""Argmax tree: the largest of outputs that come all at once, and how far the next is behind it."""

from dataclasses import dataclass

from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.port import CLOCK, Port, group, input_port
from golden.layers.argmax import Argmax
from golden.numbers.fixed import Codes, Fix


@dataclass(frozen=True)
class ArgmaxTree(Block):
    """Index and margin of the winner of a frame whose outputs come in one clock (ours).

    The numbers are those of ``Argmax``, which takes one output after the other. In each level of
    the tree, pairs of winners meet. A pair keeps the larger one, with its index, and the largest of
    the others: the loser or the second of the winner. The last clock subtracts the two.

    fmt: Format of the outputs.
    outputs: The outputs of a frame, 2 or more.

    Latency: a clock for each level, and one for the margin. A frame every clock.
    """

    block = "argmax_tree"
    part_of = "adder_graph"
    area = "layers"
    fmt: Fix
    outputs: int

    def __post_init__(self) -> None:
        _ = self.serial

    @property
    def serial(self) -> Argmax:
        """The block that gives the same numbers for outputs one after the other."""
        return Argmax(self.fmt, self.outputs, variant=self.variant)

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            CLOCK,
            *group(input_port("in_data", "output y, number *", self.fmt, "fmt"), self.outputs),
            *(port for port in self.serial.result_ports("out") if port.kind),
        )

    @property
    def levels(self) -> int:
        """The number of levels of pairs."""
        return (self.outputs - 1).bit_length()

    @property
    def latency(self) -> int:
        return self.levels + 1

    def process(self, frames: ArrayLike) -> tuple[Codes, Codes]:
        """Index and margin of the winner of each frame; see ``Argmax.process``."""
        return self.serial.process(frames)
