"""Stream multiplexer: puts a network's result into its slot among the samples."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.border import State
from golden.common.port import CLOCKED, Port, input_port, output_port
from golden.input_error import InputError
from golden.numbers.fixed import Codes, Fix


@dataclass(frozen=True)
class StreamMultiplexer(Block):
    """Replaces element ``slot`` of every frame by the result it holds (thesis section 5.5).

    fmt: Format of elements and result.
    slot: Position that is replaced, counted from 0 at the start of a frame.
    """

    block = "stream_multiplexer"
    section = "5.5"
    area = "sensing"
    latency = 1
    fmt: Fix
    slot: int

    def __post_init__(self) -> None:
        self.check(slot=(0, None))

    @property
    def count_width(self) -> int:
        """Bits of the counter of elements, which stops one after the slot."""
        return (self.slot + 1).bit_length()

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            input_port("in_valid", "`in_data` holds an element"),
            input_port("in_data", "element", self.fmt),
            input_port("in_last", "the element is the last of the frame"),
            input_port("result_valid", "`result` holds a result"),
            input_port("result", "result, held from the next clock on", self.fmt),
            output_port("out_valid", "`out_data` holds an element"),
            output_port(
                "out_data", "the element, or the stored result in place of element `slot`", self.fmt
            ),
            output_port("out_last", "the element is the last of the frame"),
        )

    @property
    def states(self) -> tuple[State, ...]:
        return (State("elements before, at most one beyond the slot", range(self.slot + 2)),)

    def process(
        self,
        data: ArrayLike,
        last: ArrayLike,
        clock: ArrayLike,
        results: ArrayLike,
        result_clock: ArrayLike,
    ) -> Codes:
        """The elements that leave, for the elements that arrive after a reset.

        data: Codes of ``fmt``, one per element.
        last: The ``last`` flag of each element.
        clock, result_clock: The clocks in which each element and each result arrive. A result is
            held from the next clock on.
        results: Codes of ``fmt``.
        """
        elements = self.fmt.check(data, f"{self.entity} data")
        words = self.fmt.check(results, f"{self.entity} results")
        ends = np.flatnonzero(last)
        index = np.arange(len(elements))
        frame = np.searchsorted(ends, index)
        start = np.concatenate([[0], ends + 1])[frame]
        held = np.searchsorted(np.asarray(result_clock), clock) - 1
        replaced = index - start == self.slot
        if (held[replaced] < 0).any():
            raise InputError(f"{self.entity}: element {self.slot} came before any result")
        return np.where(replaced, words[held] if len(words) else 0, elements)
