"""Ramp: the positions at which the profile is drawn."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from golden.block import Block
from golden.fixed import Codes, Fix


@dataclass(frozen=True)
class Ramp(Block):
    """A counter times a constant (thesis section 5.8, Figure 5.25): i_p = 0, step, 2 step, ...

    The hardware needs no multiplier: an accumulator adds ``step`` once a position.

    Parameters
    ----------
    fmt : Fix
        Format of the positions.
    step : int
        Increment, unsigned, with ``guard`` fraction bits more than ``fmt``.
    guard : int
    points : int
        Positions in all, 0 included.

    Notes
    -----
    The accumulator is exact and has ``acc_width`` bits; each position is rounded to nearest, halves
    up. A step that no code holds, as 0.05, is off by half of the guard's last place, times the
    points; ``ramp`` gives the guard enough places that a position is never more than 0.51 LSB off.

    Raises
    ------
    ValueError
        When there is no position, the step is not above 0, or the last position leaves ``fmt``.
    """

    block = "ramp"
    area = "visualisation"
    fmt: Fix
    step: int
    guard: int
    points: int

    def __post_init__(self) -> None:
        if self.points < 1 or self.step < 1 or self.guard < 1:
            raise ValueError(
                f"ramp: got {self.points} points, step={self.step}, guard={self.guard}, "
                "expected 1 or more of each"
            )
        last = (self.acc_high + (1 << (self.guard - 1))) >> self.guard
        if last > self.fmt.high:
            raise ValueError(f"ramp: the last position is {last}, expected at most {self.fmt.high}")

    @property
    def acc_high(self) -> int:
        """The accumulator at the last position."""
        return (self.points - 1) * self.step

    @property
    def acc_width(self) -> int:
        """Bits of the unsigned accumulator, with the half that rounds."""
        return (self.acc_high + (1 << (self.guard - 1))).bit_length()

    def process(self) -> Codes:
        """Codes of all positions, shape (points,), rising from 0."""
        acc = np.arange(self.points, dtype=np.int64) * self.step
        return (acc + (1 << (self.guard - 1))) >> self.guard


def ramp(fmt: Fix, step: float, stop: float) -> Ramp:
    """The ramp from 0 to ``stop`` in steps of ``step``.

    Raises
    ------
    ValueError
        When the step is not above 0, is no more than half a code, or ``stop`` is no whole number of
        steps inside ``fmt``.
    """
    for name, value in (("step", step), ("stop", stop)):
        if not 0 < value < math.inf:
            raise ValueError(f"ramp: {name}={value}, expected a number above 0")
    # Decimal fractions as written: 0.8 is sixteen times 0.05, which floats are not.
    count = Fraction(str(stop)) / Fraction(str(step))
    if count.denominator != 1 or step * 2**fmt.frac <= 0.5:
        raise ValueError(
            f"ramp: 0 to {stop} in steps of {step}, expected a whole number of steps, each more "
            f"than half an LSB of {fmt}"
        )
    points = int(count) + 1
    guard = points.bit_length() + 6
    return Ramp(fmt, round(Fraction(str(step)) * 2 ** (fmt.frac + guard)), guard, points)
