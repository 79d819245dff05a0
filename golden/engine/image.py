"""The image of a scene: what an engine that can be reloaded needs to run it."""

from __future__ import annotations

from binascii import crc_hqx
from dataclasses import dataclass, field

from golden.engine.pipeline import Pipeline
from golden.engine.program import WORD_WIDTH, Program
from golden.engine.tanh_table import tanh_table
from golden.input_error import InputError

# Bits of the sum in an engine that can be reloaded: room for 31 products that are as large as a
# product can be, so for many more of a trained network. An image whose sums need more is refused.
ACC_WIDTH = 40
# The fields of the header: lowest bit, and most bits.
LAST_ADDR = (0, 18)
BEFORE_LAST = (18, 10)
WORD_BYTES = -(-WORD_WIDTH // 8)
CHECK_BYTES = 2
# What the check starts with, before the bytes that say for which hardware an image is.
CHECK_PRESET = 0xFFFF
VERSION = 1


@dataclass(frozen=True)
class Sizes:
    """What the hardware of an engine that can be reloaded depends on.

    Parameters
    ----------
    program_words, operand_words : int
        Words of its memories, powers of two.
    segment_width : int
        Bits of q within a segment of the table of tanh; every image holds the whole table.
    pipeline : Pipeline

    Raises
    ------
    InputError
        For a number of words that is no power of two, or that an address does not reach.
    """

    program_words: int = 512
    operand_words: int = 128
    segment_width: int = 9
    pipeline: Pipeline = field(default_factory=Pipeline)

    def __post_init__(self) -> None:
        for name, most in (("program_words", LAST_ADDR[1]), ("operand_words", BEFORE_LAST[1])):
            words = getattr(self, name)
            if not 2 <= words <= 1 << most or words & (words - 1):
                raise InputError(
                    f"hardware.{name}: got {words}, expected a power of two, 2 to {1 << most}"
                )

    @property
    def program_addr_width(self) -> int:
        return self.program_words.bit_length() - 1

    @property
    def operand_addr_width(self) -> int:
        return self.operand_words.bit_length() - 1

    @property
    def segments(self) -> int:
        """Words of the table, behind which the program begins."""
        return len(tanh_table(self.segment_width).slopes)

    @property
    def check_start(self) -> int:
        """What the check is before the first byte: that of bytes that are not sent.

        They are the version of the format and what the hardware depends on, so an image for other
        hardware fails its check.
        """
        hardware = [
            VERSION,
            self.program_addr_width,
            self.operand_addr_width,
            self.segment_width,
            self.pipeline.memory_registers,
        ]
        return crc_hqx(bytes(hardware), CHECK_PRESET)

    def text(self) -> str:
        return (
            f"{self.program_words} program words, {self.operand_words} operand words, "
            f"segment_width {self.segment_width}"
        )


@dataclass(frozen=True)
class Image:
    """Contents of the program memory, and how many samples a frame has.

    Parameters
    ----------
    sizes : Sizes
        Of the hardware that it is for.
    inputs : int
    words : tuple of int
        Table and program, from address 0 on.
    notes : tuple of str
        What each of them stands for, where that is known.
    """

    sizes: Sizes
    inputs: int
    words: tuple[int, ...]
    notes: tuple[str, ...] = ()

    @property
    def program(self) -> Program:
        """What the hardware executes once the image is loaded."""
        return Program(
            self.inputs,
            self.sizes.segment_width,
            self.words[: self.sizes.segments],
            self.words[self.sizes.segments :],
            self.sizes.pipeline,
            self.notes,
        )

    @property
    def contents(self) -> tuple[int, ...]:
        """The words, and zeros up to the end of the memory."""
        return self.words + (0,) * (self.sizes.program_words - len(self.words))

    def to_bytes(self) -> bytes:
        """As it is sent: a header, the words from the last one to the first, and the check.

        Notes
        -----
        The words come in that order because then one counter is address and length, and no other
        length needs to be kept.
        """
        before_last = (self.inputs - 2) % self.sizes.operand_words
        header = ((len(self.words) - 1) << LAST_ADDR[0]) | (before_last << BEFORE_LAST[0])
        sent = b"".join(
            word.to_bytes(WORD_BYTES, "big") for word in (header, *reversed(self.words))
        )
        return sent + crc_hqx(sent, self.sizes.check_start).to_bytes(CHECK_BYTES, "big")


def image_of(program: Program, sum_bits: int, sizes: Sizes) -> Image:
    """The image of a program, for hardware of some sizes.

    Parameters
    ----------
    program : Program
        With the whole table.
    sum_bits : int
        Bits that its sums need.
    sizes : Sizes

    Raises
    ------
    InputError
        When it does not fit; the message names what is needed and what there is.
    """
    # More words are read while the counter returns, without effect; here they are defined too.
    more = 1 + sizes.pipeline.memory_registers
    words = (*program.table, *program.words, *(0 for _ in range(more)))
    needed = (
        ("program words", len(words), sizes.program_words),
        ("operand words", program.addresses, sizes.operand_words),
        ("bits of a sum", sum_bits, ACC_WIDTH),
    )
    faults = [f"{count} {what}, there are {most}" for what, count, most in needed if count > most]
    if faults:
        raise InputError(f"the image needs {'; '.join(faults)}")
    if program.segment_width != sizes.segment_width:
        raise InputError(
            f"the image needs segment_width {program.segment_width}, there is {sizes.segment_width}"
        )
    return Image(sizes, program.inputs, words, (*program.notes, *("" for _ in range(more))))
