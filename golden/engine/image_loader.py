"""image_loader: turns a stream of bytes into the words of the program memory."""

from binascii import crc_hqx
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.common.block import Block
from golden.common.port import CLOCKED, Port, Unsigned, input_port, output_port
from golden.engine.formats import WORD_WIDTH
from golden.engine.image import BEFORE_LAST, CHECK_BYTES, LAST_ADDR, WORD_BYTES


@dataclass(frozen=True)
class Loading:
    """The outputs of the loader in each clock, and the images that it accepts.

    halt, image_error: The ports of these names.
    good: For each image that passes its check the clock of its last byte, and its bytes.
    """

    halt: NDArray[np.bool_]
    image_error: NDArray[np.bool_]
    good: list[tuple[int, bytes]]


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
    part_of = "engine"
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
            output_port("write_addr", "address of `word`", Unsigned(self.program_addr_width)),
            output_port("word", "a word of the image", Unsigned(WORD_WIDTH)),
            output_port(
                "before_last", "samples of a frame minus 2", Unsigned(self.operand_addr_width)
            ),
            output_port("image_error", "the last image was not valid"),
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
        halt, error = (np.zeros(count, dtype=bool) for _ in range(2))
        good = []
        received, whole, failed = bytearray(), False, False
        for t, (valid, data, last, waits, clears) in enumerate(zip(*columns, strict=True)):
            error[t] = failed
            accepted = valid and not waits
            halt[t] = accepted or not whole
            if accepted:
                received.append(data)
                whole = False
                if last:
                    whole = self.judge(bytes(received)) is not None
                    failed = not whole
                    if whole and not clears:
                        good.append((t, bytes(received)))
                    received.clear()
            if clears:
                received.clear()
                whole = failed = False
        return Loading(halt, error, good)

    def judge(self, received: bytes) -> tuple[int, list[int]] | None:
        """The header's ``before_last`` and the words of an image; None if the image is not good.

        The words are in ascending order of their addresses.
        """
        if len(received) < WORD_BYTES:
            return None
        header = self._word(received, 0)
        low, bits = LAST_ADDR
        words = (header >> low) % (1 << bits) + 1
        whole = words <= self.words and len(received) == (1 + words) * WORD_BYTES + CHECK_BYTES
        if not whole or crc_hqx(received, self.check_start):
            return None
        before_last = (header >> BEFORE_LAST[0]) % (1 << self.operand_addr_width)
        starts = range(words * WORD_BYTES, 0, -WORD_BYTES)
        return before_last, [self._word(received, start) for start in starts]

    @staticmethod
    def _word(received: bytes | bytearray, start: int) -> int:
        word = int.from_bytes(received[start : start + WORD_BYTES], "big")
        return word & ((1 << WORD_WIDTH) - 1)
