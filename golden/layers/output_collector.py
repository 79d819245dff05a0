"""Output collector: takes results that come side by side and sends them one by one."""

from dataclasses import dataclass

from golden.common.block import Block
from golden.common.port import CLOCKED, Port, group, input_port, output_port
from golden.input_error import InputError
from golden.numbers.fixed import Fix


@dataclass(frozen=True)
class OutputCollector(Block):
    """Turns the outputs of several networks into one frame (thesis section 5.5).

    fmt: Format of the results.
    outputs: Number of results of one frame, 1 or more.
    """

    block = "output_collector"
    part_of = "cascade"
    section = "5.5"
    area = "layers"
    latency = 1
    fmt: Fix
    outputs: int

    def __post_init__(self) -> None:
        if self.outputs < 1:
            raise InputError(f"{self.entity}: got outputs={self.outputs}, expected 1 or more")

    @property
    def interval(self) -> int:
        return self.outputs

    @property
    def count_width(self) -> int:
        """Bits of the number of results that have not left yet."""
        return self.outputs.bit_length()

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            input_port("in_valid", "the results of a frame are there, for this clock"),
            *group(input_port("in_data", "result of network *", self.fmt, "fmt"), self.outputs),
            output_port("out_valid", "`out_data` holds a result"),
            output_port("out_data", "result, in the order of the networks", self.fmt, "fmt"),
            output_port("out_last", "the result is the last of the frame"),
        )
