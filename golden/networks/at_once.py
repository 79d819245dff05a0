"""Designs whose outputs come in one clock, and which find the largest of them where asked to."""

from dataclasses import dataclass, field

from golden.common.port import Port
from golden.layers.argmax_tree import ArgmaxTree
from golden.networks.design import Design
from golden.numbers.precision import SIGNAL


@dataclass(frozen=True)
class AtOnce(Design):
    """A design with a port for each output, all of which come in the same clock.

    decides: Whether there are the index and the margin of the largest output.
    """

    decides_itself = True
    decides: bool = field(default=False, kw_only=True)

    @property
    def argmax(self) -> ArgmaxTree | None:
        return ArgmaxTree(SIGNAL, self.outputs) if self.decides else None

    @property
    def ports(self) -> tuple[Port, ...]:
        winner = self.argmax.serial.result_ports("winner") if self.argmax else ()
        return (*super().ports, *winner)
