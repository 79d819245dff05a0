"""Comparator bank: finds the segment of the activation in which a magnitude lies."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.border import Border
from golden.common.port import CLOCKED, Port, Unsigned, input_port, output_port
from golden.numbers.fixed import Codes, check_unsigned


@dataclass(frozen=True)
class ComparatorBank(Block):
    """Address of the segment that holds a magnitude (thesis 4.5.2.3.1 C, Addresser of 5.4.5.2).

    mag_width: Bits of the unsigned magnitude.
    thresholds: Upper codes of the segments, strictly rising. A magnitude equal to a threshold still
        belongs to the segment below it; the first segment includes 0. Without a threshold there is
        one segment, and the address is always 0.
    """

    block = "comparator_bank"
    section = "4.5.2.3.1 C, 5.4.5.2"
    area = "activation"
    latency = 1
    mag_width: int
    thresholds: tuple[int, ...]

    def __post_init__(self) -> None:
        top = (1 << self.mag_width) - 1
        self.require(
            all(a < b for a, b in pairwise((-1, *self.thresholds, top))),
            f"thresholds {self.thresholds}",
            f"strictly rising ones from 0 to {top - 1}, for a magnitude of {self.mag_width} bits",
        )

    @property
    def addr_width(self) -> int:
        """Bits of the address, which counts from 0 to the number of thresholds."""
        return max(1, len(self.thresholds).bit_length())

    @property
    def ports(self) -> tuple[Port, ...]:
        mag = Unsigned(self.mag_width)
        return (
            *CLOCKED,
            input_port("in_valid", "`in_mag` holds a magnitude"),
            input_port("in_mag", "magnitude of q, with its fraction bits", mag),
            output_port("out_valid", "`out_addr` and `out_mag` hold a result"),
            output_port(
                "out_addr",
                "segment number less one, which is the number of thresholds exceeded",
                Unsigned(self.addr_width, last=len(self.thresholds)),
            ),
            output_port("out_mag", "`in_mag`, one clock later", mag),
        )

    @property
    def borders(self) -> tuple[Border, ...]:
        return tuple(
            Border(f"magnitude above {mark}", "magnitude", mark + 1) for mark in self.thresholds
        )

    def quantities(self, *inputs: Codes) -> dict[str, Codes]:
        return {"magnitude": inputs[0]}

    def process(self, mag: ArrayLike) -> Codes:
        """The number of thresholds that each magnitude exceeds, which is the segment's address."""
        codes = check_unsigned(mag, self.mag_width, "comparator_bank mag")
        found = np.searchsorted(np.asarray(self.thresholds), codes, side="left")
        return found.astype(np.int64)
