"""lesson_receiver: takes known outputs, and whether to learn, out of packets of a serial line."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.block import Block
from golden.border import State
from golden.fixed import Codes
from golden.input_error import InputError
from golden.link.packets import CHECK_BYTES, CODE_BYTES, LESSON, SYNC, check_of, kind_byte
from golden.port import CLOCKED, Port, Unsigned, input_port, output_port
from golden.precision import SIGNAL

# The bytes before the codes: SYNC, the kind, the length, and the bits.
HEAD_BYTES = 4
# Each code takes two bytes, and a place in a packet has at most 8 bits.
MOST_OUTPUTS = 120


@dataclass(frozen=True)
class Taught:
    """The outputs in each clock, and what the block holds.

    Attributes
    ----------
    target_valid, target_last : bool array
    target_data : int64 array
        0 in a clock without ``target_valid``, as ``target_last`` is too.
    learn, lesson_error : bool array
    place : int64 array
        The number of the byte of a packet that is next, in each clock.
    armed : bool array
        Whether known outputs wait for the end of a frame.
    """

    target_valid: NDArray[np.bool_]
    target_data: Codes
    target_last: NDArray[np.bool_]
    learn: NDArray[np.bool_]
    lesson_error: NDArray[np.bool_]
    place: Codes
    armed: NDArray[np.bool_]


@dataclass(frozen=True)
class LessonReceiver(Block):
    """Finds the packets of lessons among bytes (ours; see ``golden.link.packets``).

    A packet begins with a byte SYNC and a byte of version and kind; with another kind there is no
    packet. If it is whole and its check is right, ``learn`` becomes its bit, and its known outputs,
    if it has any, wait for the end of the next frame. Then they leave. Until then, a further packet
    takes their place, also if it is wrong.

    Parameters
    ----------
    outputs : int
        Number of known outputs.
    idle_clocks : int
        Clocks without a byte after which a packet is dropped.

    Raises
    ------
    InputError
        When either is below 1, or for more outputs than a packet has room for.
    """

    block = "lesson_receiver"
    area = "link"
    outputs: int
    idle_clocks: int

    def __post_init__(self) -> None:
        if not 1 <= self.outputs <= MOST_OUTPUTS or self.idle_clocks < 1:
            raise InputError(
                f"{self.entity}: got outputs={self.outputs} and idle_clocks={self.idle_clocks}, "
                f"expected 1 to {MOST_OUTPUTS} outputs, and 1 clock or more"
            )

    @property
    def payload_bytes(self) -> int:
        return 1 + self.outputs * CODE_BYTES

    @property
    def packet_bytes(self) -> int:
        return HEAD_BYTES - 1 + self.payload_bytes + CHECK_BYTES

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            input_port("in_valid", "`in_data` holds a byte from the line"),
            input_port("in_data", "the byte", Unsigned(8)),
            input_port("frame_end", "the last output of a frame leaves in this clock"),
            input_port("target_ready", "a known output is taken in this clock"),
            output_port("target_valid", "`target_data` holds a known output, until it is taken"),
            output_port("target_data", "known output y, in the order of the outputs", SIGNAL),
            output_port("target_last", "the known output is the last one"),
            output_port("learn", "the bit of the last packet that was right; 0 after a reset"),
            output_port(
                "lesson_error", "high for one clock for each packet that is wrong or is cut"
            ),
        )

    @property
    def states(self) -> tuple[State, ...]:
        return (
            State("byte of a packet where the line falls idle", range(self.packet_bytes)),
            State("known outputs that have left when a byte comes", range(self.outputs)),
        )

    @property
    def unreachable(self) -> dict[str, str]:
        if self.outputs > 1:
            return {}
        return {"target_last=0": "the only known output is the last one"}

    @property
    def data_flags(self) -> frozenset[str]:
        return frozenset({"target_last"})

    @property
    def latency(self) -> int:
        """Clocks from the end of a frame to the first known output."""
        return 1

    def process(
        self,
        in_valid: ArrayLike,
        in_data: ArrayLike,
        frame_end: ArrayLike,
        target_ready: ArrayLike,
        reset: ArrayLike,
    ) -> Taught:
        """The outputs in each clock; all arrays have one element for each clock."""
        columns = [
            np.asarray(c).tolist() for c in (in_valid, in_data, frame_end, target_ready, reset)
        ]
        count = len(columns[0])
        flags = np.zeros((5, count), dtype=bool)
        data, places = np.zeros(count, dtype=np.int64), np.zeros(count, dtype=np.int64)
        state = _State(self)
        for t, (comes, byte, ends, ready, clears) in enumerate(zip(*columns, strict=True)):
            places[t] = len(state.packet)
            if state.leaving:
                data[t] = state.leaving[0]
            flags[:, t] = (
                bool(state.leaving),
                len(state.leaving) == 1,
                state.learn,
                state.wrong,
                bool(state.waiting),
            )
            state.step(comes, byte, ends, ready)
            if clears:
                state = _State(self)
        valid, last, learn, wrong, armed = flags
        return Taught(valid, data, last, learn, wrong, places, armed)


class _State:
    """What the block holds from clock to clock."""

    def __init__(self, twin: LessonReceiver) -> None:
        self.twin = twin
        self.packet = b""
        self.idle = 0
        self.learn = self.wrong = False
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
        body = self.packet[1:]
        if check_of(body):
            self._drop()
            return
        bits, codes = body[2], body[3:-CHECK_BYTES]
        self.packet = b""
        self.learn = bool(bits & 1)
        if bits & 2:
            # The two highest bits of a code are not kept.
            words = [int.from_bytes(codes[n : n + 2], "big") for n in range(0, len(codes), 2)]
            wide = 1 << SIGNAL.width
            self.waiting = [(w & (wide - 1)) - (w >> (SIGNAL.width - 1) & 1) * wide for w in words]
