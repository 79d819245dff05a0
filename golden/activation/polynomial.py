"""The Polynomial activation: approximates tanh by two quadratics."""

from collections import Counter
from dataclasses import dataclass
from math import ldexp

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.activation.activation_block import COMPARATORS, ROM_WORDS, Compared
from golden.activation.scheme import Scheme
from golden.activation.segments import last_below, nearest
from golden.input_error import InputError
from golden.numbers.fixed import Codes, Fix, Rounding, cut, signed_width
from golden.numbers.precision import SIGNAL, Precision

# Thesis Table 4.2: upper bound of each quadratic, and a_n2, a_n1, a_n0.
UPPER = (1.75, 3.5)
COEFFICIENTS = ((-0.31247, 1.07571, -0.00139), (-0.02557, 0.16192, 0.74118))
BEYOND = (0.0, 0.0, 1.0)


def polynomial_real(q: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The Polynomial scheme in floating point and its slope (equation 4.24).

    Returns value, slope, the shape of ``q``: Below ``|q|`` = 0.0013, where the first quadratic is
        negative, the value is 0.
    """
    real = np.asarray(q, dtype=np.float64)
    mag = np.abs(real)
    segment = np.searchsorted(UPPER, mag, side="right")
    a2, a1, a0 = (np.array(column)[segment] for column in zip(*COEFFICIENTS, BEYOND, strict=True))
    value = np.maximum((a2 * mag + a1) * mag + a0, 0)
    return np.where(real < 0, -value, value), 2 * a2 * mag + a1


@dataclass(frozen=True)
class Polynomial(Compared):
    """r = tanh(Q qbar), approximated by two quadratics (thesis section 4.5.2.3.2, Figure 4.19).

    It computes (A_n2 qbar**2 + A_n1 qbar + A_n0) Qhat with the constants of equation 4.28. From 3.5
    on the result is 1 - 2**-frac.

    thresholds: Last magnitude code of each quadratic; one that the neuron cannot exceed is left
        out.
    coeffs: A_n2, A_n1 and A_n0 of every quadratic that the neuron can reach.
    factor: Code of the de-normalisation factor a_11 Q**2, unsigned; None where q is not normalised.
    quadratic, linear, constant: Formats of A_n2, A_n1 and A_n0.
    square_frac: Number of fraction bits that are kept of the squared magnitude.
    sum_frac: Fraction bits of the two products when they are added, and of the sum.
    factor_frac: Binary point of the factor; below 0 for a factor with more bits than fit.
    rounding: How low bits are dropped after the square, after each product, and at the end.

    The result saturates to 0 and to 1 - 2**-frac. So it is never negative, although the first
    quadratic is negative below ``|q|`` = 0.0013. A magnitude beyond the neuron's reach may have a
    wrong result.
    """

    block = "polynomial"
    section = "4.5.2.3.2"
    thresholds: tuple[int, ...]
    coeffs: tuple[tuple[int, int, int], ...]
    factor: int | None
    quadratic: Fix
    linear: Fix
    constant: Fix
    square_frac: int
    sum_frac: int
    factor_frac: int
    rounding: Rounding

    @property
    def square_shift(self) -> int:
        return 2 * self.in_fmt.frac - self.square_frac

    @property
    def square_width(self) -> int:
        """Bits of the square of the largest magnitude for which a quadratic is used, unsigned."""
        last = self.thresholds[-1] if self.saturates else self.abs_unit.fmt.high
        return int(cut(last * last, self.square_shift, self.rounding)).bit_length()

    @property
    def quadratic_shift(self) -> int:
        return self.quadratic.frac + self.square_frac - self.sum_frac

    @property
    def linear_shift(self) -> int:
        return self.linear.frac + self.in_fmt.frac - self.sum_frac

    @property
    def constant_shift(self) -> int:
        return self.sum_frac - self.constant.frac

    @property
    def out_shift(self) -> int:
        """Number of fraction bits dropped from the sum to get the result."""
        shift = self.sum_frac - self.out_fmt.frac
        return shift if self.factor is None else shift + self.factor_frac

    @property
    def saturates(self) -> bool:
        """Whether the neuron can exceed the last quadratic."""
        return len(self.thresholds) == len(self.coeffs)

    @property
    def sum_width(self) -> int:
        """Bits of the sum for every square and magnitude that the operands can hold.

        Each term rises or falls with its operand, so its extremes are at the extremes of the
        operand.
        """
        largest = (1 << self.square_width) - 1, (1 << self.abs_unit.mag_width) - 1
        bounds = []
        for a2, a1, a0 in self.coeffs:
            terms = (
                int(cut(a2 * largest[0], self.quadratic_shift, self.rounding)),
                int(cut(a1 * largest[1], self.linear_shift, self.rounding)),
            )
            offset = a0 << self.constant_shift
            bounds += [offset + sum(min(0, t) for t in terms)]
            bounds += [offset + sum(max(0, t) for t in terms)]
        return signed_width(bounds)

    @property
    def latency(self) -> int:
        # Two clocks for products and sum, and one for the de-normalisation where there is one.
        return sum(part.latency for part in self.parts()) + 2 + (self.factor is not None)

    def parts_left_out(self) -> Counter[str]:
        comparators, words = len(UPPER) - len(self.thresholds), 3 * (len(UPPER) - len(self.coeffs))
        return +Counter({COMPARATORS: comparators, ROM_WORDS: words})

    @property
    def limits(self) -> dict[str, tuple[int, int]]:
        return {"result": (0, self.out_fmt.high)}

    def curved(self, data: Codes) -> NDArray[np.bool_]:
        segment = self.comparator_bank.process(self.abs_unit.process(data)[0])
        return np.asarray(segment < len(self.coeffs))

    def unlimited(self, data: Codes) -> dict[str, Codes]:
        return {"result": cut(self.exact(data), self.out_shift, self.rounding)}

    def exact(self, data: Codes) -> Codes:
        """The result before its last bits are dropped."""
        mag, _ = self.abs_unit.process(data)
        segment = self.comparator_bank.process(mag)
        row = np.minimum(segment, len(self.coeffs) - 1)
        a2, a1, a0 = (np.array(column)[row] for column in zip(*self.coeffs, strict=True))
        kept = cut(mag * mag, self.square_shift, self.rounding)
        square = kept & ((1 << self.square_width) - 1)
        total = (
            cut(a2 * square, self.quadratic_shift, self.rounding)
            + cut(a1 * mag, self.linear_shift, self.rounding)
            + (a0 << self.constant_shift)
        )
        return np.asarray(total if self.factor is None else total * self.factor)

    def closest_to_rounding(self, count: int) -> Codes:
        """Codes above 0 whose exact results are closest to a step of the result, on either side.

        There are ``count`` codes for each side. For them a small error of a product, which rounding
        hides elsewhere, becomes visible.
        """
        codes = np.arange(self.in_fmt.high + 1)
        codes = codes[self.curved(codes)]
        exact = self.exact(codes)
        beyond = exact - (cut(exact, self.out_shift, self.rounding) << self.out_shift)
        order = np.argsort(beyond, kind="stable")
        return np.concatenate([codes[order[:count]], codes[order[-count:]]])


def normalised(factor: int) -> tuple[NDArray[np.float64], float]:
    """A_n2, A_n1, A_n0 of both quadratics for Q = ``factor``, and Qhat (equation 4.28)."""
    a11 = COEFFICIENTS[0][1]
    return np.array(COEFFICIENTS) / a11 / np.array([1, factor, factor**2]), a11 * factor**2


def polynomial_for(precision: Precision, factor: int, reach: int) -> Polynomial:
    """The Polynomial activation for a neuron normalised by ``factor`` with magnitudes to ``reach``.

    In ``thesis`` precision the formats are those of Table 4.4 for Q up to 3. For a larger Q the
    constants get smaller with Q and with Q**2, and Qhat magnifies every error by Q**2. Therefore
    A_n1 has one more fraction bit, and A_n0, products and sum have two more, for each doubling of
    Q. This keeps the error of the result as it is at Q = 3.
    """
    fmt = precision.hidden_fmt
    ends = [last_below(str(u), factor, fmt.frac) for u in UPPER]
    if not 0 < ends[0] < ends[1]:
        raise InputError(
            f"Q = {factor}: thresholds {ends} coincide in {fmt}, expected distinct codes above 0"
        )
    thresholds = tuple(end for end in ends if end < min(reach, fmt.high))
    width = precision.coeff_width
    if precision.normalise:
        values, denormalise = normalised(factor)
        # How often 3 must be doubled until it is Q or more.
        extra = (-(-factor // 3) - 1).bit_length()
        frac = precision.gradient_frac_limit
        sum_frac = frac + 2 * extra
        # The factor is unsigned, so that 9.681 has the binary point 10 of Table 4.4.
        factor_frac = max(
            p for p in range(-width, width) if nearest(ldexp(denormalise, p)) < 1 << width
        )
        scale = nearest(ldexp(denormalise, factor_frac))
        formats = Fix(width, frac), Fix(width, frac + extra), Fix(width, sum_frac)
        # The square of a magnitude has no more fraction bits than this.
        square_frac = min(sum_frac, 2 * fmt.frac)
    else:
        values, scale, factor_frac = np.array(COEFFICIENTS), None, 0
        quadratic, linear, constant = (Fix.largest_frac(width, column) for column in values.T)
        formats = quadratic, linear, constant
        # The square of 3.5 fits in 17 bits, which one input of a MULT18X18 takes; no other number
        # is cut.
        square_frac = width - 1 - 4
        sum_frac = max(quadratic.frac + square_frac, linear.frac + fmt.frac)
    rows = min(len(thresholds) + 1, len(UPPER))
    # A_11 is 1 at Q = 1, which does not fit in Fix(14,13). It saturates, with an error of one LSB.
    pairs = zip(formats, values.T, strict=True)
    columns = [f.quantise(column)[0][:rows] for f, column in pairs]
    return Polynomial(
        fmt,
        SIGNAL,
        thresholds,
        tuple((int(a2), int(a1), int(a0)) for a2, a1, a0 in zip(*columns, strict=True)),
        scale,
        *formats,
        square_frac,
        sum_frac,
        factor_frac,
        precision.rounding,
        variant=f"q{factor}c{len(thresholds)}",
    )


SCHEME = Scheme(polynomial_real, polynomial_for)
