"""The section ``[uart]`` of a scene: the serial line between the instrument and a computer."""

from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from golden.link.uart_transmitter import LEAST_DIVISOR
from tactus.core.schema import Key, KeyTable, Whole

UART = KeyTable(
    {
        "baud": Key(
            Whole(),
            1_000_000,
            "The number of bits per second. A bit must take 4 clocks or more, and the rate must be "
            "within 2 % of `clock_mhz` divided by a whole number.",
        )
    },
    name="a section",
)
# What the UART of a computer tolerates, including the deviation of its own clock.
TOLERANCE = Fraction(2, 100)


@dataclass(frozen=True)
class Uart:
    """The serial line that a scene describes.

    baud: Requested bits per second.
    divisor: Clocks per bit.
    """

    baud: int
    divisor: int


def uart(values: dict[str, Any], path: Path) -> Uart | None:
    """The serial line, if the scene has that section."""
    if "uart" not in values:
        return None
    baud, clock_mhz = values["uart"]["baud"], values["hardware"]["clock_mhz"]
    clock = Fraction(str(clock_mhz)) * 1_000_000
    most = clock / LEAST_DIVISOR
    if not 1 <= baud <= most:
        raise InputError(
            f"{path}: uart.baud: got {baud}, expected 1 to {int(most)}, a bit of {LEAST_DIVISOR} "
            f"clocks of {clock_mhz:g} MHz"
        )
    divisor = round(clock / baud)
    rate = clock / divisor
    if abs(rate / baud - 1) > TOLERANCE:
        raise InputError(
            f"{path}: uart.baud: got {baud}, expected within 2 % of {clock_mhz:g} MHz divided "
            f"by a whole number, such as {float(rate):.6g}"
        )
    return Uart(baud, divisor)
