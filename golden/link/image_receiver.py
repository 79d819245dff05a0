"""image_receiver: packets become the bytes of an image, as an engine takes them."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.block import Block
from golden.border import State
from golden.fixed import Codes
from golden.input_error import InputError
from golden.link.packets import IMAGE, SYNC, kind_byte
from golden.port import CLOCKED, Port, Unsigned, given, taken

# What a byte is in a packet: what ends the wait, the kind, two of the length, one of the image.
PLACES = 5


@dataclass(frozen=True)
class Loaded:
    """What stands on the outputs in each clock.

    Attributes
    ----------
    load_valid, load_last : bool array
    load_data : int64 array
        0 in a clock without ``load_valid``; so is ``load_last``.
    place : int64 array
        What a byte of this clock would be, of ``PLACES``.
    stored : int64 array
        Bytes that are kept.
    """

    load_valid: NDArray[np.bool_]
    load_data: Codes
    load_last: NDArray[np.bool_]
    place: Codes
    stored: Codes


@dataclass(frozen=True)
class ImageReceiver(Block):
    """Finds the packets of images among bytes (ours; see ``golden.link.packets``).

    A byte SYNC and one of version and kind begin a packet; with another version or kind, or a
    length of 0, there is none. When no byte comes for ``idle_clocks`` inside an image, it ends with
    a byte 0 more, which fails its check; before its first byte the packet is forgotten.

    Parameters
    ----------
    idle_clocks : int
        Clocks without a byte that end a packet.
    depth : int
        Bytes that come while the engine computes, at most; so many are kept.

    Raises
    ------
    InputError
        When either is below 1.
    """

    block = "image_receiver"
    area = "link"
    idle_clocks: int
    depth: int

    def __post_init__(self) -> None:
        if self.idle_clocks < 1 or self.depth < 1:
            raise InputError(
                f"{self.entity}: got idle_clocks={self.idle_clocks} and depth={self.depth}, "
                "expected 1 or more of each"
            )

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            taken("in_valid", "`in_data` holds a byte from the line"),
            taken("in_data", "the byte", Unsigned(8)),
            taken("load_ready", "a byte of the image is taken in this clock"),
            given("load_valid", "`load_data` holds a byte of an image, until it is taken"),
            given("load_data", "the byte", Unsigned(8)),
            given("load_last", "the byte is the last of the image"),
        )

    @property
    def states(self) -> tuple[State, ...]:
        return (
            State("place in a packet where the line falls idle", range(PLACES)),
            State("bytes kept", range(self.depth + 1)),
        )

    @property
    def data_flags(self) -> frozenset[str]:
        return frozenset({"load_last"})

    @property
    def latency(self) -> int:
        """From a byte of an image to the same byte, where nothing waits."""
        return 1

    def process(
        self, in_valid: ArrayLike, in_data: ArrayLike, load_ready: ArrayLike, reset: ArrayLike
    ) -> Loaded:
        """What happens in each clock; all arrays have one element a clock."""
        columns = [np.asarray(c).tolist() for c in (in_valid, in_data, load_ready, reset)]
        count = len(columns[0])
        valid, last = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
        data, places, stored = (np.zeros(count, dtype=np.int64) for _ in range(3))
        place = length = idle = 0
        kept: deque[tuple[int, bool]] = deque()
        for t, (comes, byte, ready, clears) in enumerate(zip(*columns, strict=True)):
            places[t], stored[t] = place, len(kept)
            if kept:
                valid[t] = True
                data[t], last[t] = kept[0]
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
        return Loaded(valid, data, last, places, stored)

    @staticmethod
    def _header(place: int, length: int, byte: int) -> tuple[int, int]:
        """The place behind a byte, and the length as far as it is known."""
        if place == 0:
            return int(byte == SYNC), 0
        if place == 1:
            return (2 if byte == kind_byte(IMAGE) else int(byte == SYNC)), 0
        length = length << 8 | byte
        if place == 2:
            return 3, length
        return (PLACES - 1 if length else 0), length
