"""Ramp: produces the positions at which the profile is drawn."""

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from golden.common.block import Block
from golden.common.port import CLOCKED, Port, input_port, output_port
from golden.input_error import InputError
from golden.numbers.fixed import Codes, Fix

# The ramp's constants stay below 2**30, from where on MyHDL converts them wrongly.
ACC_LIMIT = 30


@dataclass(frozen=True)
class Ramp(Block):
    """A counter times a constant (section 5.8, Figure 5.25): i_p = start + n step, n = 0, 1, ...

    The hardware needs no multiplier, because an accumulator adds ``step`` for each position.

    fmt: Format of the positions.
    start, step: First position and increment, with ``guard`` fraction bits more than ``fmt``.
    points: Number of positions, including the first.

    The accumulator is exact and has ``acc_width`` bits. Each position is rounded to nearest, halves
    up. A step that no code holds exactly, such as 0.05, causes an error of half of the guard's last
    place times the number of points. ``ramp`` chooses a guard so large that no position is more
    than 0.51 LSB off.
    """

    block = "ramp"
    part_of = "load_profile"
    section = "5.8"
    area = "visualisation"
    latency = 1
    fmt: Fix
    start: int
    step: int
    guard: int
    points: int

    def __post_init__(self) -> None:
        if self.points < 1 or self.step < 1 or self.guard < 1:
            raise InputError(
                f"ramp: got {self.points} points, step={self.step}, guard={self.guard}, "
                "expected 1 or more of each"
            )
        if self.acc_width > ACC_LIMIT:
            raise InputError(
                f"ramp: {self.points} points with guard={self.guard} need {self.acc_width} bits, "
                f"expected at most {ACC_LIMIT}"
            )
        positions = self.process()
        first, last = int(positions[0]), int(positions[-1])
        if first < self.fmt.low or last > self.fmt.high:
            raise InputError(
                f"ramp: the first position is {first}, expected at least {self.fmt.low}; "
                f"the last position is {last}, expected at most {self.fmt.high}"
            )

    @property
    def acc_low(self) -> int:
        """The accumulator at the first position, including the half unit for rounding."""
        return self.start + (1 << (self.guard - 1))

    @property
    def acc_high(self) -> int:
        """The accumulator at the last position, including the half unit for rounding."""
        return self.acc_low + (self.points - 1) * self.step

    @property
    def acc_width(self) -> int:
        """Bits of the signed accumulator: those of a position in ``fmt``, and the guard."""
        return self.fmt.width + self.guard

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            input_port("in_valid", "the next position is requested"),
            output_port("out_valid", "`out_data` holds a new position"),
            output_port("out_data", "position i_p, which stays until the next", self.fmt, "fmt"),
            output_port("out_last", "the position is the last of the ramp; held as long as it"),
        )

    def process(self) -> Codes:
        """Codes of all positions in rising order, shape (points,)."""
        acc = self.acc_low + np.arange(self.points, dtype=np.int64) * self.step
        return acc >> self.guard


def ramp(fmt: Fix, step: float, stop: float, start: float = 0.0) -> Ramp:
    """The ramp from ``start`` to ``stop`` in steps of ``step``."""
    for name, value, least in (
        ("start", start, -math.inf),
        ("stop", stop, start),
        ("step", step, 0),
    ):
        if not least < value < math.inf:
            expected = f"a number above {least:g}" if least > -math.inf else "a finite number"
            raise InputError(f"ramp: {name}={value}, expected {expected}")
    # Decimal fractions are taken as written, because 0.8 is sixteen times 0.05 only in decimal.
    first, increment = Fraction(str(start)), Fraction(str(step))
    count = (Fraction(str(stop)) - first) / increment
    if count.denominator != 1 or step * 2**fmt.frac <= 0.5:
        raise InputError(
            f"ramp: {start:g} to {stop:g} in steps of {step:g}, expected a whole number of steps, "
            f"each more than half an LSB of {fmt}"
        )
    points = int(count) + 1
    guard = points.bit_length() + 6
    unit = 2 ** (fmt.frac + guard)
    return Ramp(fmt, round(first * unit), round(increment * unit), guard, points)
