"""What blocks that read sensors in turn have in common: a counter of turns, and a pause."""

from __future__ import annotations

from golden.block import Block
from golden.input_error import InputError

# A counter of 24 bits makes a scan of 0.26 s at 64 MHz, slower than any contact.
COUNTER_WIDTHS = range(2, 25)
# From one scan to the next: 17 s at 64 MHz. MyHDL writes larger numbers wrongly.
MOST_SCAN_CLOCKS = 1 << 30


class Scan(Block):
    """A counter whose upper bits are the turn, the lower ones the clock within it.

    A subclass has ``counter_width`` and ``pause`` among its fields, and says how many turns it has.
    """

    counter_width: int
    pause: int

    def check_pause(self) -> None:
        """Refuse a pause that no counter reaches.

        Raises
        ------
        InputError
        """
        most = MOST_SCAN_CLOCKS - (1 << self.counter_width)
        if not 0 <= self.pause <= most:
            raise InputError(f"{self.entity}: got pause={self.pause}, expected 0 to {most}")

    @property
    def turns(self) -> int:
        """Turns of a scan in which something is read."""
        raise NotImplementedError

    @property
    def slot_width(self) -> int:
        """Bits of the counter that are the turn."""
        return max(1, (self.turns - 1).bit_length())

    @property
    def slot_clocks(self) -> int:
        """Clocks of a turn."""
        return 1 << (self.counter_width - self.slot_width)

    @property
    def scan_clocks(self) -> int:
        """Clocks from one scan to the next; turns above ``turns`` pass idle."""
        return (1 << self.counter_width) + self.pause
