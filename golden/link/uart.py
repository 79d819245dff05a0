"""uart_transmitter and uart_receiver: bytes on a line, in both directions."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.common.block import Block
from golden.common.port import CLOCKED, Unsigned, input_port, output_port
from golden.numbers.fixed import Codes

# A byte has a start bit, eight bits from the lowest on, and a stop bit.
BYTE_BITS = 10
# A receiver needs as many clocks of a bit to find its middle.
LEAST_DIVISOR = 4


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


@dataclass(frozen=True)
class UartReceiver(Block):
    """Receives bytes: a start bit, eight bits from the lowest, and a stop bit (ours).

    A fall of the line begins a byte if the line is still 0 half a bit later. Each further bit is
    read in its middle. If the stop bit is 0, the byte is dropped and an error is raised; the next
    byte begins with the next fall.

    divisor: Number of clocks of a bit.

    At most one clock is lost at the edge of the start bit, and the stop bit is read in its middle.
    So a bit may be 2.5 % shorter or 5.5 % longer with a divisor of 4 (tests/test_link.py).
    """

    block = "uart_receiver"
    part_of = "uart_instrument"
    area = "link"
    # Number of registers that the line passes first.
    synchroniser = 2
    divisor: int

    ports = (
        *CLOCKED,
        input_port("rx", "the line; comes at any time"),
        output_port("out_valid", "`out_data` holds a byte, for this clock"),
        output_port("out_data", "the byte, where `out_valid`", Unsigned(8)),
        output_port("line_error", "one clock long: a byte without a stop bit, which is dropped"),
    )

    @property
    def stop_clocks(self) -> int:
        """Clocks from the first clock of the start bit to that in which the stop bit is read."""
        return (BYTE_BITS - 1) * self.divisor + self.divisor // 2

    @property
    def latency(self) -> int:
        """Clocks from the first clock of the start bit on ``rx`` to the byte."""
        return self.synchroniser + self.stop_clocks + 1

    @property
    def interval(self) -> int:
        """Clocks from one start bit to the next, which may come once the stop bit is read."""
        return self.stop_clocks + 1

    def process(self, rx: ArrayLike, reset: ArrayLike) -> dict[str, Codes]:
        """The outputs by name; all arrays have one element for each clock.

        ``out_data`` is 0 where ``out_valid`` is.
        """
        line, clears = np.asarray(rx).tolist(), np.asarray(reset).tolist()
        count = len(line)
        valid, data, error = found = np.zeros((3, count), dtype=np.int64)
        # The levels of the line in the registers, its level one clock before, and the clock in
        # which the start bit began.
        late, before, began = [1] * self.synchroniser, 1, -1
        bits: list[int] = []
        for t in range(count):
            now = late[-1]
            if clears[t]:
                late, before, began = [1] * self.synchroniser, 1, -1
                continue
            if began >= 0:
                past = t - began - self.divisor // 2
                if past >= 0 and past % self.divisor == 0:
                    bits.append(now)
                    if bits[0]:
                        began = -1
                    elif len(bits) == BYTE_BITS:
                        began = -1
                        if t + 1 < count:
                            valid[t + 1], error[t + 1] = now == 1, now == 0
                            data[t + 1] = sum(b << n for n, b in enumerate(bits[1:-1])) * now
            elif before and not now:
                began, bits = t, []
            before = now
            late = [line[t], *late[:-1]]
        return dict(zip(("out_valid", "out_data", "line_error"), found, strict=True))
