"""image_loader: a stream of bytes becomes the words of the program memory."""

from __future__ import annotations

from binascii import crc_hqx
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.block import Block
from golden.border import State
from golden.engine.image import BEFORE_LAST, CHECK_BYTES, LAST_ADDR, WORD_BYTES
from golden.engine.program import WORD_WIDTH
from golden.fixed import Codes
from golden.port import CLOCKED, Port, Unsigned, given, taken


@dataclass(frozen=True)
class Loading:
    """What the loader does in each clock, and the images that it finds good.

    Attributes
    ----------
    halt, image_error, write : bool array
        The ports of these names.
    write_addr, word : int64 array
        The ports of these names in a clock of ``write``, 0 in others.
    good : list of (int, int, list of int)
        For each image that passes its check the clock of its last byte, what its header says of
        the samples of a frame, and its words.
    before : int64 array
        Bytes of the image that were taken before.
    """

    halt: NDArray[np.bool_]
    image_error: NDArray[np.bool_]
    write: NDArray[np.bool_]
    write_addr: Codes
    word: Codes
    good: list[tuple[int, int, list[int]]]
    before: Codes


@dataclass(frozen=True)
class ImageLoader(Block):
    """Writes the words of an image, checks it, and stops the engine until a good one is there.

    Parameters
    ----------
    program_addr_width, operand_addr_width : int
        Bits of the addresses of the memories.
    check_start : int
        What the check is before the first byte, 16 bits.

    Notes
    -----
    An image is good if its header names no more words than the memory has, if just these words and
    the check come, and if the check is right. Behind any other header nothing is written.

    The check is CRC-16 with the polynomial x^16 + x^12 + x^5 + 1, the highest bit of a byte first,
    nothing inverted or reflected: Python's ``binascii.crc_hqx``.
    """

    block = "image_loader"
    area = "engine"
    program_addr_width: int
    operand_addr_width: int
    check_start: int

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            taken("load_valid", "`load_data` holds a byte of an image"),
            taken("load_data", "the byte", Unsigned(8)),
            taken("load_last", "the byte is the last of the image"),
            taken("busy", "a frame is computed, so bytes must wait"),
            given("load_ready", "a byte is taken in this clock if there is one"),
            given("halt", "no frame is accepted in this clock"),
            given("write", "`word` is written to the program memory"),
            given(
                "write_addr",
                "address of `word`",
                Unsigned(self.program_addr_width),
                "program_addr_width",
            ),
            given("word", "a word of the image", Unsigned(WORD_WIDTH)),
            given(
                "before_last",
                "samples of a frame minus 2",
                Unsigned(self.operand_addr_width),
                "operand_addr_width",
            ),
            given("image_error", "the last image was not valid"),
        )

    @property
    def states(self) -> tuple[State, ...]:
        words = 1 << self.program_addr_width
        return (
            State("bytes before, at most two words", range(2 * WORD_BYTES + 1)),
            State("last address written", range(words - 1, words)),
        )

    @property
    def latency(self) -> int:
        return 0

    def process(
        self,
        load_valid: ArrayLike,
        load_data: ArrayLike,
        load_last: ArrayLike,
        busy: ArrayLike,
        reset: ArrayLike,
    ) -> Loading:
        """What happens in each clock; all arrays have one element a clock.

        Bytes are gathered until ``load_last``; only then it is asked what they are.
        """
        columns = [np.asarray(c).tolist() for c in (load_valid, load_data, load_last, busy, reset)]
        count = len(columns[0])
        halt, error, write = (np.zeros(count, dtype=bool) for _ in range(3))
        write_addr, word, before = (np.zeros(count, dtype=np.int64) for _ in range(3))
        good = []
        received, whole, failed = bytearray(), False, False
        for t, (valid, data, last, waits, clears) in enumerate(zip(*columns, strict=True)):
            error[t], before[t] = failed, len(received)
            taken_now = valid and not waits
            halt[t] = taken_now or not whole
            if taken_now:
                received.append(data)
                place = self._place(received)
                if place is not None:
                    write[t], write_addr[t] = True, place
                    word[t] = self._word(received, len(received) - WORD_BYTES)
                whole = False
                if last:
                    found = self.judge(bytes(received))
                    whole, failed = found is not None, found is None
                    if found is not None and not clears:
                        good.append((t, *found))
                    received.clear()
            if clears:
                received.clear()
                whole = failed = False
        return Loading(halt, error, write, write_addr, word, good, before)

    def judge(self, received: bytes) -> tuple[int, list[int]] | None:
        """What the header says of the samples, and the words; None for an image that is not good.

        The words are in the order of their addresses.
        """
        if len(received) < WORD_BYTES:
            return None
        header = self._word(received, 0)
        words = self._length(header)
        whole = self._fits(words) and len(received) == (1 + words) * WORD_BYTES + CHECK_BYTES
        if not whole or crc_hqx(received, self.check_start):
            return None
        before_last = (header >> BEFORE_LAST[0]) % (1 << self.operand_addr_width)
        starts = range(words * WORD_BYTES, 0, -WORD_BYTES)
        return before_last, [self._word(received, start) for start in starts]

    @staticmethod
    def _length(header: int) -> int:
        low, bits = LAST_ADDR
        return (header >> low) % (1 << bits) + 1

    def _fits(self, words: int) -> bool:
        return words <= 1 << self.program_addr_width

    def _place(self, received: bytearray) -> int | None:
        """The address of the word that is complete now, if one is."""
        number, rest = divmod(len(received), WORD_BYTES)
        if rest or number < 2:
            return None
        words = self._length(self._word(received, 0))
        place = words + 1 - number
        return place if self._fits(words) and place >= 0 else None

    @staticmethod
    def _word(received: bytes | bytearray, start: int) -> int:
        word = int.from_bytes(received[start : start + WORD_BYTES], "big")
        return word & ((1 << WORD_WIDTH) - 1)
