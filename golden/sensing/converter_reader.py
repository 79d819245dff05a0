"""Converter reader: makes frames with a converter of several channels on an SPI."""

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.common.border import Border, State
from golden.common.port import CLOCKED, Port, input_port, output_port
from golden.numbers.fixed import Codes, Fix, Overflow, Rounding, check_unsigned, cut, requantise
from golden.sensing.converter_parts import STRAIGHT, ConverterPart
from golden.sensing.scan_sequencer import COUNTER_WIDTHS, Scan


@dataclass(frozen=True)
class ConverterReader(Scan):
    """Reads each sensor with one transfer, and sends a frame if all transfers of a scan are right.

    In turn n channel n is read, at the end of the turn; before that ``cs_n`` is high. The codes are
    stored until the scan is complete. Then its frame leaves, one sample per clock. Sample n is that
    of sensor n modulo ``inputs``, so that the later slots of a cascade need no transfer.

    A scan with a transfer that no working converter can have sent yields no frame; see
    ``received``.

    fmt: Format of the samples.
    inputs: Number of sensors; each is at the channel of its own number.
    slots: Elements of a frame: ``inputs``, and in a cascade also the slots of its earlier outputs.
    counter_width: Bits of the counter for turn and clock together; all turns take 2**counter_width
        clocks.
    clock_mhz: Clock of the hardware. With it every limit of the part is kept.
    pause: Clocks without a transfer between the turns and the next scan.

    Codes with fewer bits than ``fmt`` are extended by zeros. Codes with more bits are rounded half
    up and saturated. This adds an error of at most 0.5 steps of ``fmt``, and of 0.75 for the two
    largest codes of 16 bits.
    """

    block = "converter_reader"
    area = "sensing"
    # Clocks from the last bit of a scan to the first sample of its frame.
    latency = 3
    fmt: Fix
    part: ConverterPart
    inputs: int
    slots: int
    counter_width: int
    clock_mhz: float
    pause: int = 0

    def __post_init__(self) -> None:
        part, at = self.part.name, f"{self.clock_mhz:g} MHz"
        self.require(
            1 <= self.inputs <= self.part.channels,
            f"{self.inputs} sensors",
            f"1 to {self.part.channels}, the channels of {part}",
        )
        got = f"inputs={self.inputs} and slots={self.slots}"
        self.require(self.inputs <= self.slots, got, "inputs <= slots")
        slowest = Fraction(2 * self.part.slowest_khz, 1000)
        self.require(
            self.clock >= slowest,
            f"clock_mhz={self.clock_mhz:g}",
            f"{float(slowest):g} or more, of which {part} gets half",
        )
        turn = max(self.transfer_clocks + max(2, self.part.high_clocks(self.clock)), self.slots + 1)
        least = self.slot_width + (turn - 1).bit_length()
        self.require(
            self.counter_width in range(least, COUNTER_WIDTHS.stop),
            f"counter_width={self.counter_width}",
            f"{least} to {COUNTER_WIDTHS.stop - 1}: for each of {1 << self.slot_width} turns "
            f"{part} needs {turn} clocks of {at}",
        )
        self.check_pause()

    @property
    def clock(self) -> Fraction:
        """``clock_mhz`` exactly as it was written, and not the nearest floating-point number."""
        return Fraction(str(self.clock_mhz))

    @property
    def turns(self) -> int:
        return self.inputs

    @property
    def interval(self) -> int:
        return self.scan_clocks

    @property
    def half_clocks(self) -> int:
        return self.part.half_clocks(self.clock)

    @property
    def transfer_clocks(self) -> int:
        """Clocks in which ``cs_n`` is low. The last half period has no edge of ``sclk``."""
        return (2 * self.part.clocks + 1) * self.half_clocks

    @property
    def begin_clock(self) -> int:
        """The clock of a turn that is two clocks before ``cs_n`` falls.

        It is counted from 0. ``cs_n`` rises when the next turn begins.
        """
        return self.slot_clocks - 2 - self.transfer_clocks

    @property
    def read_clocks(self) -> Codes:
        """Clocks of a scan in which ``miso`` is read, shape (inputs, part.clocks + 1).

        The first of each transfer is before it begins, where the pull-up holds the line.
        """
        bits = np.arange(self.part.clocks + 1) * 2 * self.half_clocks + self.begin_clock + 1
        return np.arange(self.inputs)[:, np.newaxis] * self.slot_clocks + bits

    @property
    def shift(self) -> int:
        """Number of bits that a code has more than a sample; below 0, that it has less."""
        return self.part.bits - self.fmt.width

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            input_port("miso", "from the converter, with a pull-up"),
            output_port("sclk", "to the converter: clock of the transfer; from a register"),
            output_port("cs_n", "to the converter: low for a transfer; from a register"),
            output_port("mosi", "to the converter: command; from a register"),
            output_port("out_valid", "`out_data` holds a new sample"),
            output_port("out_data", "sample, held until the next one", self.fmt),
            output_port("out_last", "the sample is the last of the frame"),
            output_port(
                "converter_error",
                "high from a transfer that no converter can have sent to the first scan without "
                "one; a scan with such a transfer gives no frame",
            ),
        )

    @property
    def states(self) -> tuple[State, ...]:
        return (
            State("turn", range(1 << self.slot_width)),
            State("bit of a transfer that a reset cuts", range(self.part.clocks + 1)),
        )

    @property
    def borders(self) -> tuple[Border, ...]:
        if self.shift <= 0:
            return ()
        return (Border("a sample saturates", "rounded code", self.fmt.high + 1),)

    def quantities(self, *inputs: Codes) -> dict[str, Codes]:
        (codes,) = inputs
        return {"rounded code": cut(self._signed(codes), max(0, self.shift), Rounding.ROUND)}

    def process(self, codes: ArrayLike) -> Codes:
        """The samples for codes of the converter."""
        signed = self._signed(check_unsigned(codes, self.part.bits, f"{self.entity} codes"))
        if self.shift <= 0:
            return np.asarray(signed << -self.shift, dtype=np.int64)
        return requantise(signed, self.shift, self.fmt, Rounding.ROUND, Overflow.SATURATE)

    def _signed(self, codes: Codes) -> Codes:
        half = 1 << (self.part.bits - 1)
        if self.part.coding == STRAIGHT:
            return codes - half
        return np.asarray((codes ^ half) - half, dtype=np.int64)

    def converted(self, voltages: ArrayLike) -> Codes:
        """The nearest codes of an ideal converter for voltages in codes of ``fmt``."""
        levels = self.fmt.check(voltages, f"{self.entity} voltages")
        own = Fix(self.part.bits, 0)
        if self.shift >= 0:
            signed = levels << self.shift
        else:
            signed = requantise(levels, -self.shift, own, Rounding.ROUND, Overflow.SATURATE)
        half = 1 << (self.part.bits - 1)
        if self.part.coding == STRAIGHT:
            return np.asarray(signed + half, dtype=np.int64)
        return np.asarray(signed % (2 * half), dtype=np.int64)

    def received(self, bits: ArrayLike) -> tuple[Codes, NDArray[np.bool_]]:
        """Codes of transfers, and whether a working converter can have sent them.

        Before a transfer the pull-up holds ``miso`` at 1; in the clocks ``part.zeros`` the
        converter holds it at 0; and a converter that repeats its code repeats it unchanged.

        bits, shape (..., part.clocks + 1): The level of ``miso`` before the transfer and in each of
            its clocks.
        """
        part, sent = self.part, np.asarray(bits, dtype=np.int64)
        code = sent[..., part.first : part.last + 1]
        right = (sent[..., 0] == 1) & ~sent[..., list(part.zeros)].any(axis=-1)
        if part.mirrored:
            again = sent[..., part.last : part.last + part.bits]
            right = right & (again == code[..., ::-1]).all(axis=-1)
        return code @ (1 << np.arange(part.bits)[::-1]), right
