"""image_receiver: turns packets into the bytes of an image for an engine."""

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.port import CLOCKED, Unsigned, input_port, output_port
from golden.link.packets import IMAGE, SYNC, kind_byte
from golden.numbers.fixed import Codes

# The states of a packet: waiting for SYNC, the kind, two bytes of the length, and the image.
PLACES = 5


@dataclass(frozen=True)
class ImageReceiver(Block):
    """Finds the packets of images among bytes (ours; see ``golden.link.packets``).

    A packet begins with a byte SYNC and a byte of version and kind. With another version or kind,
    or a length of 0, there is no packet. When no byte comes for ``idle_clocks`` inside an image,
    the image is ended with a further byte 0, so that its check fails. If this happens before the
    length is complete, the packet is dropped.

    idle_clocks: Clocks without a byte after which a packet ends.
    depth: Number of bytes that can be stored: the most that come while the engine computes.
    """

    block = "image_receiver"
    part_of = "uart_instrument"
    area = "link"
    data_flags = frozenset({"load_last"})
    # Clocks from a byte of an image to the same byte at the output, if none waits.
    latency = 1
    idle_clocks: int
    depth: int

    def __post_init__(self) -> None:
        self.check(idle_clocks=(1, None), depth=(1, None))

    ports = (
        *CLOCKED,
        input_port("in_valid", "`in_data` holds a byte from the line"),
        input_port("in_data", "the byte", Unsigned(8)),
        input_port("load_ready", "a byte of the image is taken in this clock"),
        output_port("load_valid", "`load_data` holds a byte of an image, until it is taken"),
        output_port("load_data", "the byte", Unsigned(8)),
        output_port("load_last", "the byte is the last of the image"),
    )

    def process(
        self, in_valid: ArrayLike, in_data: ArrayLike, load_ready: ArrayLike, reset: ArrayLike
    ) -> dict[str, Codes]:
        """The outputs by name; all arrays have one element for each clock.

        Where ``load_valid`` is 0 the others are 0 too.
        """
        columns = [np.asarray(c).tolist() for c in (in_valid, in_data, load_ready, reset)]
        found = np.zeros((3, len(columns[0])), dtype=np.int64)
        place = length = idle = 0
        kept: deque[tuple[int, bool]] = deque()
        for t, (comes, byte, ready, clears) in enumerate(zip(*columns, strict=True)):
            if kept:
                found[:, t] = True, *kept[0]
            if clears:
                place = length = idle = 0
                kept.clear()
                continue
            if kept and ready:
                kept.popleft()
            over = not comes and idle == self.idle_clocks - 1
            idle = 0 if comes or over else idle + 1
            if place == PLACES - 1 and (comes or over):
                length -= 1
                ends = over or length == 0
                kept.append((byte if comes else 0, ends))
                place = 0 if ends else place
            elif comes:
                place, length = self._header(place, length, byte)
            elif over:
                place = 0
        return dict(zip(("load_valid", "load_data", "load_last"), found, strict=True))

    @staticmethod
    def _header(place: int, length: int, byte: int) -> tuple[int, int]:
        """The state after a byte, and as much of the length as is known."""
        if place == 0:
            return int(byte == SYNC), 0
        if place == 1:
            return (2 if byte == kind_byte(IMAGE) else int(byte == SYNC)), 0
        length = length << 8 | byte
        if place == 2:
            return 3, length
        return (PLACES - 1 if length else 0), length
