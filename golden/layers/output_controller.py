"""CONTROLLER 2: steps through the outputs of a frame."""

from dataclasses import dataclass

import numpy as np

from golden.common.block import Block
from golden.common.port import CLOCKED, Port, Unsigned, input_port, output_port
from golden.numbers.fixed import Codes


@dataclass(frozen=True)
class OutputController(Block):
    """Gives the row address of each output in turn (thesis section 5.4.5.3, CONTROLLER 2).

    outputs: Outputs of one frame, 1 or more.

    The name of the entity contains ``outputs``, so that controllers of equal frames are one entity.
    """

    block = "output_controller"
    section = "5.4.5.3"
    area = "layers"
    latency = 0
    outputs: int

    def __post_init__(self) -> None:
        self.check(outputs=(1, None))

    @property
    def entity(self) -> str:
        return f"{super().entity}_of_{self.outputs}"

    @property
    def interval(self) -> int:
        return self.outputs

    @property
    def addr_width(self) -> int:
        return max(1, (self.outputs - 1).bit_length())

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            input_port(
                "in_valid",
                "one clock long: the activations of a frame are valid for `outputs` clocks",
            ),
            output_port(
                "addr",
                "row of weights, 0 in the clock of `in_valid`, then one row a clock",
                Unsigned(self.addr_width, last=self.outputs - 1),
            ),
            output_port("out_valid", "`addr` holds a row"),
            output_port("out_last", "the row is the last of the frame"),
        )

    def process(self, frames: int) -> Codes:
        """Row addresses of ``frames`` frames, shape (frames, outputs)."""
        return np.tile(np.arange(self.outputs, dtype=np.int64), (frames, 1))
