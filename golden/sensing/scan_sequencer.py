"""Scan sequencer: reads the sensors in turn through an analogue multiplexer."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.border import State
from golden.common.port import CLOCKED, Port, Unsigned, input_port, output_port
from golden.numbers.fixed import Codes, Fix

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
        self.check(pause=(0, MOST_SCAN_CLOCKS - (1 << self.counter_width)))

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
        return 1 << (self.counter_width - self.slot_width)

    @property
    def scan_clocks(self) -> int:
        """Clocks from one scan to the next; in turns beyond ``turns`` nothing is read."""
        return (1 << self.counter_width) + self.pause


@dataclass(frozen=True)
class ScanSequencer(Scan):
    """A counter and its slices (thesis sections 5.4.4 and 5.5).

    Slot n selects sensor n modulo ``inputs``. Late in each slot, when the multiplexer has settled,
    the converter's code is accepted. Slower scans pause behind the slots, so that the samples of a
    frame stay close together in time.

    fmt: Format of the converter's codes and of the samples.
    inputs: Number of sensors.
    slots: Elements of a frame: ``inputs``, and in a cascade also the slots of its earlier outputs.
    counter_width: Bits of the counter for slot and clock together; all slots take 2**counter_width
        clocks.
    sample_clock: Clock of a slot in which the code is accepted, counted from 0. In clock 0 the
        address is still that of the slot before.
    pause: Clocks between the slots and the next scan, in which the first sensor is selected.
    """

    block = "scan_sequencer"
    section = "5.4.4, 5.5"
    area = "sensing"
    latency = 1
    fmt: Fix
    inputs: int
    slots: int
    counter_width: int
    sample_clock: int
    pause: int = 0

    def __post_init__(self) -> None:
        got = f"inputs={self.inputs} and slots={self.slots}"
        self.require(1 <= self.inputs <= self.slots, got, "1 <= inputs <= slots")
        least = max(COUNTER_WIDTHS.start, self.slot_width + 1)
        self.require(
            self.counter_width in range(least, COUNTER_WIDTHS.stop),
            f"counter_width={self.counter_width}",
            f"{least} to {COUNTER_WIDTHS.stop - 1} for {self.slots} slots",
        )
        self.check(sample_clock=(1, self.slot_clocks - 1))
        self.check_pause()

    @property
    def turns(self) -> int:
        return self.slots

    @property
    def address_width(self) -> int:
        return max(1, (self.inputs - 1).bit_length())

    @property
    def interval(self) -> int:
        """Clocks from one accepted code to the next."""
        return self.slot_clocks

    @property
    def addresses(self) -> tuple[int, ...]:
        """The sensor that is selected in each slot, idle slots included.

        In idle slots and in the pause the first sensor is selected, so that it settles.
        """
        idle = (1 << self.slot_width) - self.slots
        return tuple(n % self.inputs for n in range(self.slots)) + (0,) * idle

    def address_at(self, clocks: ArrayLike) -> Codes:
        """The sensor that is selected ``clocks`` clocks after the beginning of a scan."""
        turns = np.asarray(clocks) % self.scan_clocks // self.slot_clocks
        in_pause = [0]
        found = np.array([*self.addresses, *in_pause])
        at: Codes = found[np.minimum(turns, len(self.addresses))]
        return at

    @property
    def sample_clocks(self) -> Codes:
        """The clocks of a scan in which a code is accepted, in ascending order."""
        return np.arange(self.slots) * self.slot_clocks + self.sample_clock

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            input_port(
                "adc", "code of the converter, of the sensor that `address` selects", self.fmt
            ),
            output_port(
                "address",
                "to the analogue multiplexer: sensor that is selected; from a register",
                Unsigned(self.address_width),
            ),
            output_port("out_valid", "`out_data` holds a new sample"),
            output_port("out_data", "sample, held until the next one", self.fmt),
            output_port("out_last", "the sample is the last of the frame"),
        )

    @property
    def states(self) -> tuple[State, ...]:
        return (State("slot", range(1 << self.slot_width)),)

    @property
    def unreachable(self) -> dict[str, str]:
        return {
            f"address={n}": f"there are {self.inputs} sensors"
            for n in range(self.inputs, 1 << self.address_width)
        }

    def process(self, scans: ArrayLike) -> Codes:
        """Frames, shape (scans, slots), from the converter's codes in every clock of the scans.

        scans: shape (scans, scan_clocks).
        """
        codes = self.fmt.check(scans, f"{self.entity} codes", self.scan_clocks)
        return codes[..., self.sample_clocks]
