"""The Pade activation: tanh as a fraction, whose denominator is inverted by iteration."""

import warnings
from collections import Counter
from dataclasses import dataclass
from math import floor, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.activation.activation_block import COMPARATORS, Compared
from golden.activation.scheme import Option, Scheme
from golden.input_error import InputError
from golden.numbers.fixed import Codes, Fix, Overflow, Rounding, cut, requantise, signed_width
from golden.numbers.precision import SIGNAL, Precision

# Equation 4.6: coefficients of q**2 and q**4.
NUMERATOR = (1 / 9, 1 / 945)
DENOMINATOR = (4 / 9, 1 / 63)
GATE = 3.3
RHO = 4.5
ITERATIONS = 32

# A regression that stops further from its limit than this gives a warning, in units of 2**-13.
SETTLED = 2.0


class UnsettledWarning(UserWarning):
    """The regression stops before it is near its limit, or it has no limit."""


def fraction(q: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A(q) and B(q) of equation 4.10."""
    s = q * q
    a = 1 + s * (NUMERATOR[0] + s * NUMERATOR[1])
    b = 1 + s * (DENOMINATOR[0] + s * DENOMINATOR[1])
    return a, b


def pade_real(
    q: ArrayLike, rho: float = RHO, iterations: int = ITERATIONS
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The Pade scheme in floating point and its slope (equations 4.10 and 4.12).

    After m steps from 0 the regression is at (1 - (1 - B / rho)**m) / B.

    rho: Convergence rate.

    Returns value, slope, the shape of ``q``: Beyond ``|q| = 3.3`` the value is 1; inside, it
        saturates to 0 and 1.
    """
    real = np.asarray(q, dtype=np.float64)
    mag = np.abs(real)
    inner = np.minimum(mag, GATE)
    a, b = fraction(inner)
    a_slope = inner * (2 * NUMERATOR[0] + 4 * NUMERATOR[1] * inner**2)
    b_slope = inner * (2 * DENOMINATOR[0] + 4 * DENOMINATOR[1] * inner**2)
    ratio = 1 - b / rho
    with np.errstate(over="ignore", invalid="ignore"):
        settled = 1 - ratio**iterations
        value = np.nan_to_num(inner * a / b * settled)
        slope = (a + inner * a_slope - inner * a * b_slope / b) / b * settled
        slope += inner * a / b * iterations * ratio ** (iterations - 1) * b_slope / rho
    beyond = mag > GATE
    clipped = np.where(beyond, 1.0, np.clip(value, 0, 1))
    slope = np.where(beyond | (value != np.clip(value, 0, 1)), 0.0, slope)
    return np.where(real < 0, -clipped, clipped), slope


def distance(rho: float, iterations: int, top: float) -> tuple[float, float]:
    """How far from its limit the regression can stop, and for which ``|q|`` up to ``top``.

    Returns units: In units of 2**-13; infinite where the regression diverges.
    """
    q = np.linspace(0, min(top, GATE), 3301)
    a, b = fraction(q)
    ratio = np.abs(1 - b / rho)
    with np.errstate(over="ignore"):
        units = 8192 * q * a / b * ratio**iterations
    units[ratio >= 1] = np.inf
    worst = int(np.argmax(units))
    return float(units[worst]), float(q[worst])


def stable_below(rho: float) -> float:
    """The ``|q|`` at which B(q) = 2 rho, from which on the regression diverges."""
    c, d = DENOMINATOR
    return sqrt((sqrt(c * c + 4 * d * (2 * rho - 1)) - c) / (2 * d))


@dataclass(frozen=True)
class Horner:
    """The polynomial k0 + s (k1 + s k2), with low bits dropped after each product.

    k0, k1, k2: The constants as codes.
    out_frac, inner_frac, k2_frac: Fraction bits: of k0 and the result, of k1 and the bracket, and
        of k2.
    """

    k0: int
    k1: int
    k2: int
    out_frac: int
    inner_frac: int
    k2_frac: int

    def shifts(self, square_frac: int) -> tuple[int, int]:
        """Number of fraction bits dropped after the first and after the second product."""
        return (
            square_frac + self.k2_frac - self.inner_frac,
            square_frac + self.inner_frac - self.out_frac,
        )

    def process(self, square: Codes, square_frac: int, rounding: Rounding) -> tuple[Codes, Codes]:
        """Compute the bracket and the result."""
        first, second = self.shifts(square_frac)
        bracket = self.k1 + cut(self.k2 * square, first, rounding)
        return bracket, self.k0 + cut(bracket * square, second, rounding)


@dataclass(frozen=True)
class Pade(Compared):
    """r = tanh(Q qbar) = q A(q) d, with d near 1 / B(q) (thesis 4.5.2.3.3, Figure 4.20).

    d comes from the regression of equation 4.12, d <- 1 / rho - d (B - rho) / rho, which takes one
    clock per step on one multiplier. Beyond ``|q| = 3.3`` the result is 1 - 2**-frac.

    factor: Q. The magnitude is multiplied by it first, so nothing later depends on Q.
    thresholds: The last magnitude code that is not above 3.3, where the neuron can exceed it;
        otherwise empty.
    iterations: Steps of the regression, from d = 0.
    numerator: The polynomial A(q).
    ratio: The polynomial (B(q) - rho) / rho; each step reduces the distance to the limit by this
        factor.
    start: 1 / rho in the format of d, which is the result of the first step.
    square_frac, dividend_frac: Fraction bits that are kept of q**2, and of q A(q).
    reciprocal: Format of d.
    rounding: How low bits are dropped, everywhere in the block.

    d saturates in its format, and the result saturates to 0 and to 1 - 2**-frac. So a regression
    that diverges gives a wrong magnitude, but neither a wrong sign nor an overflow.
    """

    block = "pade"
    section = "4.5.2.3.3"
    factor: int
    thresholds: tuple[int, ...]
    iterations: int
    numerator: Horner
    ratio: Horner
    start: int
    square_frac: int
    dividend_frac: int
    reciprocal: Fix
    rounding: Rounding

    @property
    def interval(self) -> int:
        return self.iterations

    @property
    def q_width(self) -> int:
        """Bits of the largest q up to the gate, unsigned."""
        return self.last.bit_length()

    @property
    def ratio_width(self) -> int:
        return self.widths(self.last)["ratio"]

    @property
    def dividend_width(self) -> int:
        """Bits of q A(q) up to the gate, unsigned."""
        return self.widths(self.last)["dividend"] - 1

    @property
    def square_shift(self) -> int:
        return 2 * self.in_fmt.frac - self.square_frac

    @property
    def dividend_shift(self) -> int:
        return self.in_fmt.frac + self.numerator.out_frac - self.dividend_frac

    @property
    def out_shift(self) -> int:
        return self.dividend_frac + self.reciprocal.frac - self.out_fmt.frac

    @property
    def last(self) -> int:
        """The code of the largest q up to the gate."""
        return self.factor * (self.thresholds[0] if self.thresholds else self.abs_unit.fmt.high)

    def polynomials(self, q: Codes) -> dict[str, Codes]:
        """All numbers computed from q before the regression, in full width; all rise with q.

        Returns: ``square``; ``ratio_bracket`` and ``ratio``, (B(q) - rho) / rho;
            ``numerator_bracket`` and ``numerator``, A(q); ``dividend``, q A(q).
        """
        square = cut(q * q, self.square_shift, self.rounding)
        fracs = self.square_frac, self.rounding
        ratio_bracket, ratio = self.ratio.process(square, *fracs)
        numerator_bracket, numerator = self.numerator.process(square, *fracs)
        return {
            "square": square,
            "ratio_bracket": ratio_bracket,
            "ratio": ratio,
            "numerator_bracket": numerator_bracket,
            "numerator": numerator,
            "dividend": cut(q * numerator, self.dividend_shift, self.rounding),
        }

    def widths(self, last: int) -> dict[str, int]:
        """Bits, with the sign, of each number of ``polynomials`` for q from 0 to ``last``."""
        ends = self.polynomials(np.array([0, last]))
        return {name: signed_width(int(e) for e in pair) for name, pair in ends.items()}

    @property
    def latency(self) -> int:
        # After the comparator bank the square takes one clock and the polynomials take two; then
        # follow one clock for every iteration, and one for the quotient.
        return sum(part.latency for part in self.parts()) + 3 + self.iterations + 1

    def parts_left_out(self) -> Counter[str]:
        return +Counter({COMPARATORS: 1 - len(self.thresholds)})

    @property
    def limits(self) -> dict[str, tuple[int, int]]:
        kept = self.reciprocal
        steps = {f"step {n}": (kept.low, kept.high) for n in range(2, self.iterations + 1)}
        return steps | {"result": (0, self.out_fmt.high)}

    def curved(self, data: Codes) -> NDArray[np.bool_]:
        return np.asarray(self.comparator_bank.process(self.abs_unit.process(data)[0]) == 0)

    def unlimited(self, data: Codes) -> dict[str, Codes]:
        mag, _ = self.abs_unit.process(data)
        # Beyond the gate the upper bits may be dropped, because the result is not used there.
        q = (mag * self.factor) & ((1 << self.q_width) - 1)
        found = self.polynomials(q)
        kept = Fix(self.ratio_width, 0)
        ratio = requantise(found["ratio"], 0, kept, self.rounding, Overflow.WRAP)
        dividend = found["dividend"] & ((1 << self.dividend_width) - 1)
        d = np.full_like(mag, self.start)
        limits, numbers = self.reciprocal, {}
        for n in range(2, self.iterations + 1):
            numbers[f"step {n}"] = self.start - cut(d * ratio, self.ratio.out_frac, self.rounding)
            d = np.clip(numbers[f"step {n}"], limits.low, limits.high)
        return numbers | {"result": cut(dividend * d, self.out_shift, self.rounding)}


def _horner(values: tuple[float, float, float], out: int, inner: int, width: int) -> Horner:
    """The constants of k0 + s (k1 + s k2); k2 has as many fraction bits as ``width`` allows."""
    k2_frac = max(p for p in range(3 * width) if abs(values[2]) * 2**p < 2 ** (width - 1) - 0.5)
    k0, k1, k2 = (floor(v * 2**p + 0.5) for v, p in zip(values, (out, inner, k2_frac), strict=True))
    return Horner(k0, k1, k2, out, inner, k2_frac)


def pade_for(
    precision: Precision, factor: int, reach: int, rho: float = RHO, iterations: int = ITERATIONS
) -> Pade:
    """The Pade activation for a neuron normalised by ``factor`` with magnitudes to ``reach``.

    Warns with UnsettledWarning: When, for some q that the neuron can reach, the regression diverges
        or stops more than two units of 2**-13 from its limit.
    """
    fmt = precision.hidden_fmt
    top = min(reach, fmt.high)
    end = floor(GATE * 10) * (1 << fmt.frac) // (10 * factor)
    if end < 1:
        raise InputError(f"Q = {factor}: {GATE} / Q is below one code of {fmt}")
    units, where = distance(rho, iterations, top * factor / 2**fmt.frac)
    if units > SETTLED:
        found = f"{units:.3g} units of 2**-13 short" if np.isfinite(units) else "divergent"
        warnings.warn(
            f"pade: rho = {rho:g} with {iterations} iterations is {found} at |q| = {where:.3g}, "
            f"expected at most {SETTLED:g}; rho = {RHO:g} with {ITERATIONS} iterations settles",
            UnsettledWarning,
            stacklevel=2,
        )
    width = precision.coeff_width
    if precision.coeff_frac is None:
        # Every input of a multiplier has 18 bits, because q**2 is below 16, the brackets and, from
        # rho = 3.87 on, (B - rho) / rho are below 1, A is below 4, q A is below 8, and d is below
        # 2.
        square_frac, dividend_frac, reciprocal = width - 5, width - 4, Fix(width, width - 2)
        inner, ratio, a = width - 1, width - 1, width - 3
    else:
        # All numbers have the fraction bits of the signals, in words as wide as their values need.
        frac = precision.coeff_frac
        square_frac, dividend_frac, reciprocal = frac, frac, Fix(width + 1, frac)
        inner, ratio, a = frac, frac, frac
    start = floor(2**reciprocal.frac / rho + 0.5)
    if start > reciprocal.high or start < 1:
        raise InputError(f"pade: rho = {rho:g}: 1 / rho does not fit {reciprocal}")
    beyond = (end,) if end < top else ()
    return Pade(
        fmt,
        SIGNAL,
        factor,
        beyond,
        iterations,
        _horner((1.0, *NUMERATOR), a, inner, width),
        _horner((1 / rho - 1, DENOMINATOR[0] / rho, DENOMINATOR[1] / rho), ratio, inner, width),
        start,
        square_frac,
        dividend_frac,
        reciprocal,
        precision.rounding,
        variant=f"q{factor}c{len(beyond)}",
    )


SCHEME = Scheme(
    pade_real,
    pade_for,
    {"rho": Option(RHO, real=True), "iterations": Option(ITERATIONS, real=True)},
)
