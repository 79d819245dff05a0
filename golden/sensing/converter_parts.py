"""Analogue-to-digital converters that can be bought: their interfaces and limits as data."""

from dataclasses import dataclass, replace
from fractions import Fraction

# The codes go from 0 to the reference voltage, or from minus to plus the reference about a common
# voltage.
STRAIGHT, TWOS = "straight binary", "two's complement"
# A pull-up of 10 kilohm charges 40 picofarad of pads and wires to 0.7 of the supply in 480 ns.
PULL_UP_NS = 500
# Delay of the pads of both chips and of the wires between them, there and back.
WIRES_NS = 50


@dataclass(frozen=True)
class ConverterPart:
    """A converter of several channels on an SPI of mode 0.

    Both sides read a bit at the rising edge of ``sclk`` and send the next one at its falling edge.
    A transfer is the time in which ``cs_n`` is low. Its clocks are counted from 1, and the bit of
    clock n is the one on the wire at the n-th rising edge. While ``cs_n`` is high the converter
    does not drive ``miso``, and a pull-up holds it at 1.

    bits: Bits of a code, which is sent with the most significant bit first.
    coding: STRAIGHT or TWOS.
    commands: For each channel the bits that select it, from clock 1 on. All later bits are 0.
    first: The clock of the code's most significant bit.
    clocks: Number of clocks of a transfer.
    zeros: Clocks in which the converter drives 0, against the pull-up.
    mirrored: Whether the converter repeats the code in reverse order, beginning with its second
        least significant bit.
    fastest_khz, slowest_khz: The highest and the lowest frequency of ``sclk``.
    high_ns, low_ns: The shortest times for which ``sclk`` may be high and low.
    select_ns, deselect_ns: The shortest time from the fall of ``cs_n`` to the first rise of
        ``sclk``, and the shortest time for which ``cs_n`` may be high.
    setup_ns, hold_ns: The shortest times for which a bit must be stable on ``mosi`` before and
        after a rise of ``sclk``.
    output_ns, release_ns: The longest time from a fall of ``sclk`` to the next bit, and from the
        rise of ``cs_n`` until ``miso`` is released.
    acquisition_clocks, acquisition_ns: For how many clocks of a transfer the converter tracks its
        input, and for how long it must.
    source: The data sheet.
    """

    name: str
    bits: int
    coding: str
    commands: tuple[str, ...]
    first: int
    clocks: int
    zeros: tuple[int, ...]
    mirrored: bool
    fastest_khz: int
    slowest_khz: int
    high_ns: int
    low_ns: int
    select_ns: int
    deselect_ns: int
    setup_ns: int
    hold_ns: int
    output_ns: int
    release_ns: int
    acquisition_clocks: Fraction
    acquisition_ns: int
    source: str

    @property
    def channels(self) -> int:
        return len(self.commands)

    @property
    def last(self) -> int:
        """The clock of the code's least significant bit."""
        return self.first + self.bits - 1

    def half_clocks(self, clock_mhz: Fraction) -> int:
        """The fewest clocks of half a period of ``sclk`` that keep all limits.

        ``cs_n`` falls and bits change half a period before ``sclk`` rises. ``miso`` is read at the
        end of the half period in which ``sclk`` is high, which is a whole period after its bit was
        requested.
        """
        whole_ns = (
            Fraction(1_000_000, self.fastest_khz),
            Fraction(self.output_ns + WIRES_NS),
            self.acquisition_ns / self.acquisition_clocks,
        )
        halves_ns = (self.high_ns, self.low_ns, self.select_ns, self.setup_ns, self.hold_ns)
        return max(1, _clocks(max(*whole_ns, Fraction(2 * max(halves_ns))) / 2, clock_mhz))

    def high_clocks(self, clock_mhz: Fraction) -> int:
        """The fewest clocks for which ``cs_n`` is high between two transfers.

        In this time the converter releases ``miso``, and the pull-up brings the wire to 1.
        """
        return _clocks(max(self.deselect_ns, self.release_ns + PULL_UP_NS), clock_mhz)


def _clocks(time_ns: Fraction | int, clock_mhz: Fraction) -> int:
    """The fewest whole clocks that last at least so long."""
    return -int(-Fraction(time_ns) * clock_mhz / 1000 // 1)


# The command is the start bit, single-ended, and the channel. The clock after it ends the tracking
# of the input.
_MCP3208 = ConverterPart(
    name="mcp3208",
    bits=12,
    coding=STRAIGHT,
    commands=tuple(f"11{channel:03b}" for channel in range(8)),
    first=8,
    clocks=30,
    zeros=(7,),
    mirrored=True,
    fastest_khz=1000,
    slowest_khz=10,
    high_ns=250,
    low_ns=250,
    select_ns=100,
    deselect_ns=500,
    setup_ns=50,
    hold_ns=50,
    output_ns=200,
    release_ns=100,
    acquisition_clocks=Fraction(3, 2),
    acquisition_ns=0,
    source="Microchip DS21298E, MCP3204/3208, supply of 2.7 V and more",
)
# The command is the start bit, the channel, a bit without meaning, single-ended, and no power-down
# with an external clock. The numbers of the channels are not in ascending order.
_ADS8344 = ConverterPart(
    name="ads8344",
    bits=16,
    coding=STRAIGHT,
    commands=tuple(
        f"1{channel}0111" for channel in ("000", "100", "001", "101", "010", "110", "011", "111")
    ),
    first=10,
    clocks=27,
    zeros=(26, 27),
    mirrored=False,
    fastest_khz=2400,
    slowest_khz=24,
    high_ns=200,
    low_ns=200,
    select_ns=100,
    deselect_ns=0,
    setup_ns=100,
    hold_ns=10,
    output_ns=200,
    release_ns=200,
    acquisition_clocks=Fraction(9, 2),
    # This is the value for 5 V, where it is longer than with 2.7 V.
    acquisition_ns=1700,
    source="Texas Instruments SBAS139E, ADS8344, supply of 2.7 V and more",
)

# By the name that a scene uses.
PARTS = {
    part.name: part
    for part in (
        _MCP3208,
        replace(
            _MCP3208,
            name="mcp3208-5v",
            fastest_khz=2000,
            source="Microchip DS21298E, MCP3204/3208, supply of 5 V",
        ),
        _ADS8344,
        replace(
            _ADS8344,
            name="ads8345",
            coding=TWOS,
            source="Texas Instruments SBAS177C, ADS8345, supply of 2.7 V and more",
        ),
    )
}
