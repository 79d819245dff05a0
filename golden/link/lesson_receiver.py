"""lesson_receiver: takes known outputs, theta, and whether to learn, out of bytes of a line."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.port import CLOCKED, Unsigned, input_port, output_port
from golden.link.packets import CHECK_BYTES, CODE_BYTES, LESSON, SYNC, check_of, kind_byte
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL

# The bytes before the codes: SYNC, the kind, the length, and the bits.
HEAD_BYTES = 4
# Each code takes two bytes, and a place in a packet has at most 8 bits.
MOST_CODES = 120


@dataclass(frozen=True)
class LessonReceiver(Block):
    """Finds the packets of lessons among bytes (ours; see ``golden.link.packets``).

    A packet begins with a byte SYNC and a byte of version and kind; with another kind there is no
    packet. If it is whole and its check is right, ``learn`` becomes its bit, and its known outputs
    or its theta, if it has any, wait for the end of the next frame. Then they leave. Until then, a
    further packet takes their place, also if it is wrong. With both bits they are theta.

    outputs: Number of known outputs.
    elements: Number of elements of theta.
    idle_clocks: Clocks without a byte after which a packet is dropped.
    """

    block = "lesson_receiver"
    part_of = "uart_instrument"
    area = "link"
    data_flags = frozenset({"target_last"})
    # Clocks from the end of a frame to the first known output.
    latency = 1
    outputs: int
    elements: int
    idle_clocks: int

    def __post_init__(self) -> None:
        self.check(outputs=(1, MOST_CODES), elements=(1, MOST_CODES), idle_clocks=(1, None))

    @property
    def codes(self) -> int:
        return max(self.outputs, self.elements)

    @property
    def payload_bytes(self) -> int:
        return 1 + self.codes * CODE_BYTES

    @property
    def packet_bytes(self) -> int:
        return HEAD_BYTES - 1 + self.payload_bytes + CHECK_BYTES

    ports = (
        *CLOCKED,
        input_port("in_valid", "`in_data` holds a byte from the line"),
        input_port("in_data", "the byte", Unsigned(8)),
        input_port("frame_end", "the last output of a frame leaves in this clock"),
        input_port("target_ready", "a code is taken in this clock"),
        output_port("target_valid", "`target_data` holds a code, until it is taken"),
        output_port(
            "target_data", "known output y, or an element of theta, in their order", SIGNAL
        ),
        output_port("target_last", "the code is the last one"),
        output_port("target_theta", "the code is an element of theta"),
        output_port("learn", "the bit of the last packet that was right; 0 after a reset"),
        output_port("lesson_error", "high for one clock for each packet that is wrong or is cut"),
    )

    def process(
        self,
        in_valid: ArrayLike,
        in_data: ArrayLike,
        frame_end: ArrayLike,
        target_ready: ArrayLike,
        reset: ArrayLike,
    ) -> dict[str, Codes]:
        """The outputs by name; all arrays have one element for each clock.

        Where ``target_valid`` is 0, so are the data and flags of the target.
        """
        columns = [
            np.asarray(c).tolist() for c in (in_valid, in_data, frame_end, target_ready, reset)
        ]
        names = [port.name for port in self.ports if port.direction == "out"]
        found = np.zeros((len(names), len(columns[0])), dtype=np.int64)
        state = _State(self)
        for t, (comes, byte, ends, ready, clears) in enumerate(zip(*columns, strict=True)):
            if state.leaving:
                found[:4, t] = True, state.leaving[0], len(state.leaving) == 1, state.theta
            found[4:, t] = state.learn, state.wrong
            state.step(comes, byte, ends, ready)
            if clears:
                state = _State(self)
        return dict(zip(names, found, strict=True))


class _State:
    """What the block holds from clock to clock."""

    def __init__(self, twin: LessonReceiver) -> None:
        self.twin = twin
        self.packet = b""
        self.idle = 0
        self.learn = self.theta = self.wrong = False
        self.waiting: list[int] = []
        self.leaving: list[int] = []

    def step(self, comes: int, byte: int, ends: int, ready: int) -> None:
        """Advance by one clock."""
        over = not comes and self.idle == self.twin.idle_clocks - 1
        self.idle = 0 if comes or over else self.idle + 1
        busy = bool(self.leaving)
        if self.leaving and ready:
            self.leaving = self.leaving[1:]
        if ends and self.waiting:
            self.waiting, self.leaving = [], self.waiting
        self.wrong = False
        if over:
            self._drop()
        elif comes:
            self._take(byte, busy)

    def _drop(self) -> None:
        """A packet whose kind is known is wrong."""
        self.wrong = len(self.packet) > 1
        self.packet = b""

    def _take(self, byte: int, busy: bool) -> None:
        before, twin = len(self.packet), self.twin
        self.packet += bytes([byte])
        if before == 0:
            self.packet = self.packet if byte == SYNC else b""
        elif before == 1:
            if byte != kind_byte(LESSON):
                self.packet = bytes([SYNC]) if byte == SYNC else b""
        elif before == 2 and byte != twin.payload_bytes:
            self._drop()
        elif before >= HEAD_BYTES - 1 and busy:
            # The known outputs that leave stand where those of the packet would.
            self._drop()
        elif before == HEAD_BYTES - 1:
            self.waiting = []
        elif len(self.packet) == twin.packet_bytes:
            self._judge()

    def _judge(self) -> None:
        """A packet is whole."""
        body, twin = self.packet[1:], self.twin
        if check_of(body):
            self._drop()
            return
        bits, codes = body[2], body[3:-CHECK_BYTES]
        self.packet = b""
        self.learn, self.theta = bool(bits & 1), bool(bits & 4)
        if bits & 6:
            # The two highest bits of a code are not kept.
            words = [int.from_bytes(codes[n : n + 2], "big") for n in range(0, len(codes), 2)]
            wide = 1 << SIGNAL.width
            found = [(w & (wide - 1)) - (w >> (SIGNAL.width - 1) & 1) * wide for w in words]
            self.waiting = found[: twin.elements if self.theta else twin.outputs]
