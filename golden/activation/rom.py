"""The read-only memory that g_memory, i_memory and exp_memory share."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.port import Port, Unsigned, input_port, output_port
from golden.numbers.fixed import Codes, check_unsigned, real_texts


@dataclass(frozen=True)
class Rom(Block):
    """Unsigned words, read by address without a clock.

    words: The contents. An address beyond the last word reads the last word.
    width: Bits of a word.
    frac: Fraction bits of a word, which stands for ``word / 2**frac``.
    """

    area = "activation"
    latency = 0
    # The meanings of address and word, for ``ports``.
    port_meanings: ClassVar[tuple[str, str]]
    words: tuple[int, ...]
    width: int
    frac: int

    def __post_init__(self) -> None:
        top = (1 << self.width) - 1
        self.require(
            bool(self.words) and min(self.words) >= 0 and max(self.words) <= top,
            f"words {self.words}",
            f"at least one, each 0 to {top}",
        )

    @property
    def addr_width(self) -> int:
        return max(1, (len(self.words) - 1).bit_length())

    @property
    def ports(self) -> tuple[Port, ...]:
        address, word = self.port_meanings
        return (
            input_port("addr", address, Unsigned(self.addr_width)),
            output_port("word", word, Unsigned(self.width, self.frac)),
        )

    def facts(self) -> tuple[str, ...]:
        return (f"{len(self.words)} words of {self.width} bits",)

    @property
    def meanings(self) -> list[str]:
        return real_texts(self.words, self.frac)

    def process(self, addr: ArrayLike) -> Codes:
        """The word at each address."""
        codes = check_unsigned(addr, self.addr_width, f"{self.block} addr")
        inside = np.minimum(codes, len(self.words) - 1)
        return np.asarray(np.take(self.words, inside), dtype=np.int64)
