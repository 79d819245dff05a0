"""uart_transmitter: turns bytes into bits on a line."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.common.block import Block
from golden.common.port import CLOCKED, Unsigned, input_port, output_port
from golden.input_error import InputError
from golden.numbers.fixed import Codes

# A byte has a start bit, eight bits from the lowest on, and a stop bit.
BYTE_BITS = 10
LEAST_DIVISOR = 4


def check_divisor(entity: str, divisor: int) -> None:
    """Refuse a bit of fewer clocks than a receiver needs to find its middle."""
    if divisor < LEAST_DIVISOR:
        raise InputError(f"{entity}: got divisor={divisor}, expected {LEAST_DIVISOR} or more")


def bits_of(byte: int) -> tuple[int, ...]:
    """The levels of the line for a byte, bit by bit."""
    return (0, *(byte >> n & 1 for n in range(8)), 1)


@dataclass(frozen=True)
class UartTransmitter(Block):
    """Sends a byte as start bit, eight bits from the lowest, stop bit; between bytes 1 (ours).

    divisor: Number of clocks of a bit.
    """

    block = "uart_transmitter"
    part_of = "uart_instrument"
    area = "link"
    # Clocks from the clock in which a byte is accepted to its start bit.
    latency = 1
    divisor: int

    def __post_init__(self) -> None:
        check_divisor(self.entity, self.divisor)

    ports = (
        *CLOCKED,
        input_port("in_valid", "`in_data` holds a byte"),
        input_port("in_data", "the byte", Unsigned(8)),
        output_port("in_ready", "a byte is taken in this clock if there is one"),
        output_port("tx", "the line; from a register"),
    )

    @property
    def interval(self) -> int:
        return BYTE_BITS * self.divisor

    def process(
        self, in_valid: ArrayLike, in_data: ArrayLike, reset: ArrayLike
    ) -> tuple[NDArray[np.bool_], Codes]:
        """``in_ready`` and ``tx`` in each clock; all arrays have one element for each clock."""
        columns = [np.asarray(column).tolist() for column in (in_valid, in_data, reset)]
        count = len(columns[0])
        ready, tx = np.ones(count, dtype=bool), np.ones(count, dtype=np.int64)
        # The first clock in which the next byte is accepted.
        free = 0
        for t, (valid, data, clears) in enumerate(zip(*columns, strict=True)):
            ready[t] = t >= free
            if clears:
                # A reset stops the byte that is being sent.
                tx[t + 1 :], free = 1, t + 1
            elif valid and ready[t]:
                sent = np.repeat(bits_of(data), self.divisor)[: count - t - 1]
                tx[t + 1 : t + 1 + len(sent)], free = sent, t + self.interval
        return ready, tx
