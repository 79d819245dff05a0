"""image_loader: turns a stream of bytes into the words of the program memory."""

from binascii import crc_hqx
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.common.block import Block
from golden.common.border import State
from golden.common.port import CLOCKED, Port, Unsigned, input_port, output_port
from golden.engine.formats import WORD_WIDTH
from golden.engine.image import BEFORE_LAST, CHECK_BYTES, LAST_ADDR, WORD_BYTES
from golden.numbers.fixed import Codes


@dataclass(frozen=True)
class Loading:
    """The outputs of the loader in each clock, and the images that it accepts.

    halt, image_error, write: The ports of these names.
    write_addr, word: The ports of these names in clocks in which ``write`` is high; 0 in the
        others.
    good: For each image that passes its check: the clock of its last byte, the header's field
        ``before_last`` (samples of a frame minus 2), and the words.
    before: How many bytes of the image were accepted before this clock.
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
    """Writes the words of an image, checks it, and halts the engine until an image is good.

    words: Words of the memory that an image is loaded into.
    operand_addr_width: Bits of the address of the operand memory.
    check_start: Value of the check before the first byte, 16 bits.

    An image is good if its header announces no more words than the memory has, if exactly these
    words and the check follow, and if the check is right. When the header announces too many words,
    nothing is written.

    The check is CRC-16 with the polynomial x^16 + x^12 + x^5 + 1. It takes the highest bit of a
    byte first, and inverts and reflects nothing, like Python's ``binascii.crc_hqx``.
    """

    block = "image_loader"
    area = "engine"
    latency = 0
    words: int
    operand_addr_width: int
    check_start: int

    @property
    def program_addr_width(self) -> int:
        return (self.words - 1).bit_length()

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            input_port("load_valid", "`load_data` holds a byte of an image"),
            input_port("load_data", "the byte", Unsigned(8)),
            input_port("load_last", "the byte is the last of the image"),
            input_port("busy", "a frame is computed, so bytes must wait"),
            output_port("load_ready", "a byte is taken in this clock if there is one"),
            output_port("halt", "no frame is accepted in this clock"),
            output_port("write", "`word` is written to the program memory"),
            output_port(
                "write_addr",
                "address of `word`",
                Unsigned(self.program_addr_width),
                "program_addr_width",
            ),
            output_port("word", "a word of the image", Unsigned(WORD_WIDTH)),
            output_port(
                "before_last",
                "samples of a frame minus 2",
                Unsigned(self.operand_addr_width),
                "operand_addr_width",
            ),
            output_port("image_error", "the last image was not valid"),
        )

    @property
    def states(self) -> tuple[State, ...]:
        return (
            State("bytes before, at most two words", range(2 * WORD_BYTES + 1)),
            State("last address written", range(self.words - 1, self.words)),
        )

    def process(
        self,
        load_valid: ArrayLike,
        load_data: ArrayLike,
        load_last: ArrayLike,
        busy: ArrayLike,
        reset: ArrayLike,
    ) -> Loading:
        """The outputs in each clock; all arrays have one element for each clock.

        The bytes of an image are gathered until ``load_last``, and are interpreted only then.
        """
        columns = [np.asarray(c).tolist() for c in (load_valid, load_data, load_last, busy, reset)]
        count = len(columns[0])
        halt, error, write = (np.zeros(count, dtype=bool) for _ in range(3))
        write_addr, word, before = (np.zeros(count, dtype=np.int64) for _ in range(3))
        good = []
        received, whole, failed = bytearray(), False, False
        for t, (valid, data, last, waits, clears) in enumerate(zip(*columns, strict=True)):
            error[t], before[t] = failed, len(received)
            accepted = valid and not waits
            halt[t] = accepted or not whole
            if accepted:
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
        """The header's ``before_last`` and the words of an image; None if the image is not good.

        The words are in ascending order of their addresses.
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
        return words <= self.words

    def _place(self, received: bytearray) -> int | None:
        """The address of the word that the last byte completes; None if it completes none."""
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
