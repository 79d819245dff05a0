"""load_profile: computes equation 3.18 for one frame of network outputs, point by point."""

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import ArrayLike

from golden.activation.rom import Rom
from golden.common.block import Block
from golden.common.border import Border, State
from golden.common.flow import Flow, Wire
from golden.common.port import CLOCK, CLOCKED, Port, Unsigned, input_port, output_port
from golden.input_error import InputError
from golden.numbers.fixed import Codes, Fix, Overflow, Rounding, check_unsigned, cut, requantise
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from golden.numbers.transcendental import exp_floors
from golden.visualisation.divider import Divider
from golden.visualisation.power_fold import PowerFold

RECTANGLE, TRIANGLE = 6, 2  # P of either shape, section 5.8

# Rectangular loads are coded 0.45 and triangular ones 0.9 (Table 3.1). The threshold is halfway.
SHAPE_THRESHOLD = 0.675

# An unsigned number of 17 bits fits one signed input of a MULT18X18.
WORD = 17
# t is below 4 and t**P below 16, since exp(-16) is a thousandth of an LSB of Fix(14,13).
T_FRAC, POWER_FRAC = 15, 13
ADDR_WIDTH = 10

# What full scale of the digit's coded position and width is in millimetres: neighbouring placements
# are 6.35 mm apart (thesis section 3.8.2) and 0.045 in the table, and load A, 50.8 mm wide, is 0.9.
POSITION_MM, WIDTH_MM = 127.0, 50.8
# C times the coded width of the digit: 2 divided by the width in units of the position.
GAIN = 2 * Fraction(str(POSITION_MM)) / Fraction(str(WIDTH_MM))

# One clock for the difference, and one for the magnitude.
DISTANCE_CLOCKS = 2
# One clock for the product with the load, and one for the register of the point.
END_CLOCKS = 2


class ExpMemory(Rom):
    """ROM of exp(-x), addressed by the upper bits of x (thesis section 5.8, Figure 5.25).

    Unlike other ROMs it is read with a clock, because it is a block RAM.
    """

    block = "exp_memory"
    part_of = "load_profile"
    section = "5.8"
    area = "visualisation"
    port_meanings = ("upper bits of x", "exp(-x) in the middle of the interval")
    latency = 1

    @property
    def ports(self) -> tuple[Port, ...]:
        return CLOCK, *super().ports


def exp_memory(addr_width: int, interval_frac: int, width: int) -> ExpMemory:
    """The memory of 2**addr_width words, each for an interval of 2**-interval_frac.

    Word n is exp(-(n + 1/2) / 2**interval_frac), unsigned with ``width`` fraction bits, rounded to
    nearest. It is below 1, so ``width`` bits hold it. 1024 words of 17 bits are one block RAM.
    """
    interval = Fraction(1, 1 << interval_frac)
    floors = exp_floors(interval / 2, interval, 1 << addr_width, width + 1)
    return ExpMemory(tuple(cut(floors, 1, Rounding.ROUND).tolist()), width, width)


@dataclass(frozen=True)
class ExpInterpolator(Block):
    """exp(-x) = word (1 - delta), in which the word of the memory is also the slope.

    The word is exp(-x0) in the middle x0 of an interval, and delta = x - x0. The derivative of
    exp(-x) at x0 is -exp(-x0), the negative of the word, so no second table is needed.

    word_width: Bits of the word, all of them fraction bits, unsigned.
    offset_width: Bits of x below the memory's address.
    frac: Fraction bits of x.

    The factor 1 - delta is exact and unsigned, with ``factor_width`` bits. The product is truncated
    to the word's format. The straight line lies 0 to delta**2 / 2 below exp(-x), at most 2**-15 for
    an interval of 2**-6; truncation adds an error of 1 LSB of the word. The result is below 1.
    """

    block = "exp_interpolator"
    part_of = "load_profile"
    area = "visualisation"
    latency = 2
    word_width: int
    offset_width: int
    frac: int

    @property
    def factor_width(self) -> int:
        """Bits of the unsigned 1 - delta, which is at most slightly more than 1."""
        return self.frac + 1

    @property
    def ports(self) -> tuple[Port, ...]:
        word = Unsigned(self.word_width, self.word_width)
        return (
            *CLOCKED,
            input_port("in_valid", "word and offset are there, for this clock"),
            input_port("in_word", "exp(-x0)", word),
            input_port("in_offset", "lower bits of x", Unsigned(self.offset_width, self.frac)),
            output_port("out_valid", "`out_data` holds a result"),
            output_port("out_data", "exp(-x)", word),
        )

    def process(self, word: ArrayLike, offset: ArrayLike) -> Codes:
        """exp(-x) in the word's format; the arguments are broadcast."""
        w = check_unsigned(word, self.word_width, "exp_interpolator word")
        low = check_unsigned(offset, self.offset_width, "exp_interpolator offset")
        # The factor is 1 - delta, with delta = offset - half an interval.
        factor = (1 << self.frac) + (1 << (self.offset_width - 1)) - low
        return (w * factor) >> self.frac


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
        self.check(points=(1, None), step=(1, None), guard=(1, None))
        self.require(
            self.acc_width <= ACC_LIMIT,
            f"{self.points} points with guard={self.guard}, which take {self.acc_width} bits",
            f"{ACC_LIMIT} at most",
        )
        first, last = self.process()[[0, -1]]
        self.require(
            self.fmt.low <= first and last <= self.fmt.high,
            f"positions from {first} to {last}",
            f"{self.fmt.low} to {self.fmt.high}",
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
            output_port("out_data", "position i_p, which stays until the next", self.fmt),
            output_port("out_last", "the position is the last of the ramp; held as long as it"),
        )

    def process(self) -> Codes:
        """Codes of all positions in rising order, shape (points,)."""
        acc = self.acc_low + np.arange(self.points, dtype=np.int64) * self.step
        return acc >> self.guard


def ramp(fmt: Fix, step: float, stop: float, start: float = 0.0) -> Ramp:
    """The ramp from ``start`` to ``stop`` in steps of ``step``."""
    ends = (step, start, stop)
    steps = Fraction(0)
    if np.isfinite(ends).all() and step * 2**fmt.frac > 0.5:
        # Decimal fractions are taken as written: 0.8 is sixteen times 0.05 only in decimal.
        increment, first, last = (Fraction(str(end)) for end in ends)
        steps = (last - first) / increment
    if steps <= 0 or steps.denominator != 1:
        raise InputError(
            f"ramp: {start:g} to {stop:g} in steps of {step:g}, expected a whole number of steps "
            f"upwards, each more than half an LSB of {fmt}"
        )
    points = int(steps) + 1
    guard = points.bit_length() + 6
    unit = 2 ** (fmt.frac + guard)
    return Ramp(fmt, round(first * unit), round(increment * unit), guard, points)


@dataclass(frozen=True)
class LoadProfile(Block):
    """f(i_p) = d exp(-(C (i_p - i_m))**P) over a ramp (thesis equation 3.18, section 5.8).

    A frame is load d, position i_m, width w and shape s, as the networks give them. P is 2 where
    s > ``shape_threshold``, else 6. C is such that f falls to d / e at half a width from the
    centre: C = gain / w.

    fmt: Format of the four inputs, of i_p and of f.
    shape_threshold: Code of ``fmt``.

    A width of 0 or less, which a network can give for a load that it hardly sees, counts as the
    narrowest width, 1 LSB: f is then d at i_p = i_m and 0 elsewhere. A load below 0 gives a profile
    below 0. The product with d is exact and rounded half up. It always fits in ``fmt``, because
    ``|f| <= |d|``.

    The error against equation 3.18 is at most 1.81 units of 2**-13 for d = 1, for every t that the
    divider can give and every fraction that it drops (tests/test_visualisation.py, exhaustive).
    """

    block = "load_profile"
    section = "5.8"
    area = "visualisation"
    fmt: Fix
    ramp: Ramp
    divider: Divider
    power_fold: PowerFold
    exp_memory: ExpMemory
    exp_interpolator: ExpInterpolator
    shape_threshold: int

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            input_port("in_valid", "the results of a frame are there, for this clock"),
            input_port("in_load", "load d", self.fmt),
            input_port("in_position", "position i_m", self.fmt),
            input_port("in_width", "width w", self.fmt),
            input_port("in_shape", "shape s", self.fmt),
            output_port("out_valid", "`out_x` and `out_y` hold a new point"),
            output_port("out_x", "i_p, which stays until the next point", self.fmt),
            output_port("out_y", "f(i_p), which stays until the next point", self.fmt),
            output_port("out_last", "the point is the last of the ramp; high for one clock"),
        )

    @property
    def borders(self) -> tuple[Border, ...]:
        first, last = (int(p) for p in self.ramp.process()[[0, -1]])
        lowest = "the ramp begins with the lowest code" if first == self.fmt.low else ""
        highest = "the ramp ends with the highest code" if last == self.fmt.high else ""
        return (
            Border("triangle", "shape", self.shape_threshold + 1),
            Border("width not below 0", "width", 0),
            # A width of 0 counts as 1.
            Border("wider than the narrowest", "width", 2),
            Border("load not below 0", "load", 0),
            Border("on the ramp", "position", first, 1, lowest),
            Border("behind the ramp", "position", last + 1, 1, highest),
        )

    @property
    def states(self) -> tuple[State, ...]:
        return (State("point", range(self.ramp.points)),)

    @property
    def latency(self) -> int:
        """Clocks from the results to the first point, and from one point to the next."""
        # The 1 is the clock to the ramp, from a result or from the point before.
        return 1 + DISTANCE_CLOCKS + END_CLOCKS + sum(part.latency for part in self.parts())

    @property
    def interval(self) -> int:
        """Least clocks between the results of two frames if both are to be drawn."""
        return self.ramp.points * self.latency

    def parts(self) -> tuple[Block, ...]:
        return (self.ramp, self.divider, self.power_fold, self.exp_memory, self.exp_interpolator)

    def flow(self) -> Flow:
        return Flow(
            (
                self.ramp,
                Wire("distance", self.divider.distance_width),
                self.divider,
                Wire("t", self.divider.out_width),
                self.power_fold,
                Wire("x", self.power_fold.out_width),
                self.exp_memory,
                Wire("word", self.exp_memory.width),
                self.exp_interpolator,
                Wire("exp(-x)", self.exp_interpolator.word_width),
            ),
            across=True,
        )

    def process(self, frames: ArrayLike) -> tuple[Codes, Codes]:
        """Positions, shape (points,), and profiles, shape (..., points), for frames.

        frames, shape (..., 4): Codes of load, position, width and shape.
        """
        codes = self.fmt.check(frames, "load_profile frames", 4)
        load = codes[..., 0, np.newaxis]
        return self.ramp.process(), self.height(load, *self.fall(codes))

    def fall(self, frames: Codes) -> tuple[Codes, Codes]:
        """t for every point of the frames, shape (..., points), and P, shape (..., 1)."""
        centre, width, shape = (frames[..., n, np.newaxis] for n in (1, 2, 3))
        distance = np.abs(self.ramp.process() - centre)
        t = self.divider.process(distance, np.maximum(width, 0))
        return t, np.where(shape > self.shape_threshold, TRIANGLE, RECTANGLE)

    def real(self, frames: ArrayLike) -> Real:
        """Equation 3.18 in real arithmetic at the same codes, shape (..., points).

        frames: shape (..., 4).
        """
        codes = np.asarray(frames, dtype=np.int64)[..., np.newaxis]
        load, centre, width = (self.fmt.to_real(codes[..., n, :]) for n in range(3))
        gain = self.divider.gain / 2**self.divider.gain_frac
        steepness = gain / np.maximum(width, self.fmt.to_real(1))
        positions = self.fmt.to_real(self.ramp.process())
        triangle, rectangle = (
            power_load(positions, load, centre, steepness, p) for p in (TRIANGLE, RECTANGLE)
        )
        return np.where(codes[..., 3, :] > self.shape_threshold, triangle, rectangle)

    def height(self, load: Codes, t: Codes, power: Codes) -> Codes:
        """d exp(-t**P) in ``fmt``; the arguments are broadcast.

        load, t, power: Codes of ``fmt`` for the load, quotients of the divider for t, and P.
        """
        x = self.power_fold.process(t, power)
        split = self.exp_interpolator.offset_width
        word = self.exp_memory.process(x >> split)
        value = self.exp_interpolator.process(word, x & ((1 << split) - 1))
        exact = load * value
        return requantise(
            exact, self.exp_interpolator.word_width, self.fmt, Rounding.ROUND, Overflow.SATURATE
        )


def power_load(
    position: Real, load: Real | float, centre: Real | float, steepness: Real | float, power: int
) -> Real:
    """Equation 3.18 in floating point: d exp(-(C (i_p - i_m))**P); the arguments are broadcast.

    C**P alone would overflow for narrow loads. A power beyond the largest float becomes infinity,
    whose exponential is 0, which is right.
    """
    with np.errstate(over="ignore", under="ignore"):
        return np.asarray(load * np.exp(-((steepness * (position - centre)) ** power)))


def load_profile(
    step: float = 0.05,
    stop: float = 0.8,
    start: float = 0.0,
    gain: Fraction = GAIN,
    shape_threshold: float = SHAPE_THRESHOLD,
) -> LoadProfile:
    """The profile over ``start`` to ``stop`` in steps of ``step``; thesis section 5.8 by default.

    gain: C times the coded width; see ``GAIN``.
    """
    if not 0 < gain < 1 << WORD:
        raise InputError(f"load_profile: gain={float(gain):g}, expected above 0, below {1 << WORD}")
    # The fewest fraction bits that hold the gain exactly; if there are none, as many as fit in 17
    # bits.
    gain_frac = next(
        (f for f in range(T_FRAC + 1) if (gain * 2**f).denominator == 1),
        max(0, min(T_FRAC, WORD - int(gain).bit_length())),
    )
    offset_width = WORD - ADDR_WIDTH
    return LoadProfile(
        SIGNAL,
        ramp(SIGNAL, step, stop, start),
        # |i_p - i_m| can be 2**14 - 1, which is from the most negative code to the largest.
        Divider(
            SIGNAL.width, SIGNAL.width - 1, round(gain * 2**gain_frac), gain_frac, WORD, T_FRAC
        ),
        PowerFold(WORD, T_FRAC, WORD, POWER_FRAC, max(RECTANGLE, TRIANGLE)),
        exp_memory(ADDR_WIDTH, POWER_FRAC - offset_width, WORD),
        ExpInterpolator(WORD, offset_width, POWER_FRAC),
        int(SIGNAL.quantise(shape_threshold)[0]),
    )
