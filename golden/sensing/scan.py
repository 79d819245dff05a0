"""What blocks that read sensors in turn have in common: a counter of turns, and a pause."""

from golden.common.block import Block
from golden.input_error import InputError

# A counter of 24 bits makes a scan of 0.26 s at 64 MHz, which is slower than any contact bounces.
COUNTER_WIDTHS = range(2, 25)
# From one scan to the next, which is 17 s at 64 MHz. MyHDL writes larger numbers wrongly.
MOST_SCAN_CLOCKS = 1 << 30


class Scan(Block):
    """A counter whose upper bits are the number of the turn, and its lower bits the clock in it.

    A subclass has ``counter_width`` and ``pause`` among its fields, and defines ``turns``.
    """

    counter_width: int
    pause: int

    def check_pause(self) -> None:
        """Refuse a pause that the counter cannot reach."""
        most = MOST_SCAN_CLOCKS - (1 << self.counter_width)
        if not 0 <= self.pause <= most:
            raise InputError(f"{self.entity}: got pause={self.pause}, expected 0 to {most}")

    @property
    def turns(self) -> int:
        """The number of turns of a scan in which something is read."""
        raise NotImplementedError

    @property
    def slot_width(self) -> int:
        """Bits of the counter that hold the number of the turn."""
        return max(1, (self.turns - 1).bit_length())

    @property
    def slot_clocks(self) -> int:
        """The number of clocks of a turn."""
        return 1 << (self.counter_width - self.slot_width)

    @property
    def scan_clocks(self) -> int:
        """Clocks from one scan to the next; in turns beyond ``turns`` nothing is read."""
        return (1 << self.counter_width) + self.pause
