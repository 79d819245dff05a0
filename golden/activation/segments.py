"""The nine straight segments of the Gradient scheme and their constants for a neuron.

Thesis Table 4.1 gives upper bound, gradient g_n and intercept i_n of each segment of tanh(q). A
neuron whose input is normalised by Q works on qbar = q / Q, so its thresholds are q_n / Q and its
gradients are G_n = g_n Q (equation 4.23). Beyond the last threshold the result is 1 - 2**-frac.
"""

from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.input_error import InputError
from golden.numbers.fixed import Fix, Rounding
from golden.numbers.precision import SIGNAL, Precision

UPPER = (0.5, 1.0, 1.2, 1.5, 1.8, 2.05, 2.45, 3.15, 4.0)
GRADIENT = (0.93046, 0.59805, 0.35986, 0.23741, 0.1381, 0.082, 0.0441, 0.0154, 0.0034)
INTERCEPT = (0.00767, 0.1793, 0.4039, 0.552, 0.7001, 0.8001, 0.8783, 0.9498, 0.9862)

# One signed input of a MULT18X18 holds an unsigned coefficient of 17 bits.
COEFF_WIDTH_LIMIT = 17


def nearest(value: float) -> int:
    """The integer nearest to a value that is not negative; halves are rounded up.

    The constants that are rounded here are single products and quotients of floats, which IEEE 754
    defines to the last bit.
    """
    return int(value + 0.5)


def last_below(upper: str, factor: float, frac: int) -> int:
    """The largest magnitude code m with m factor / 2**frac below a decimal number."""
    return ceil(Fraction(upper) / Fraction(factor) * (1 << frac)) - 1


def gradient_real(q: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The Gradient scheme in floating point and its slope (equation 4.3).

    Returns value, slope, the shape of ``q``: The value at q = 0 is the intercept of the first
        segment, as in the hardware.
    """
    real = np.asarray(q, dtype=np.float64)
    segment = np.searchsorted(UPPER, np.abs(real))
    slope = np.array([*GRADIENT, 0.0])[segment]
    value = slope * np.abs(real) + np.array([*INTERCEPT, 1.0])[segment]
    return np.where(real < 0, -value, value), slope


@dataclass(frozen=True)
class SegmentTable:
    """Constants of the segments that a neuron can reach, as unsigned codes.

    ``coeffs`` and ``intercepts`` hold one word per threshold and one more for what lies beyond
    the last threshold.
    """

    thresholds: tuple[int, ...]
    coeffs: tuple[int, ...]
    coeff_frac: int
    intercepts: tuple[int, ...]

    @property
    def coeff_width(self) -> int:
        return max(1, max(self.coeffs).bit_length())


def coefficient_codes(factor: float, width: int, frac_limit: int) -> tuple[list[int], int]:
    """Gradients g_n * factor as unsigned codes that share one binary point.

    factor: Q of the neuron.
    width: Signed width, 14 or 18, to which each coefficient is rounded at its own binary point.
    frac_limit: Most fraction bits that a coefficient may have.

    Returns frac: The common binary point.

    A coefficient has the largest binary point at which it fits ``width`` bits: for width 14, limit
    13 and Q = 3 these are the points 11, 12, 12, 13, ... of Table 4.3. All codes are written with
    the finest of these points, so the hardware needs no shifter. Where that would take more than 17
    bits (Q above 17), the common point moves up until the widest coefficient fits. Every
    coefficient is rounded only once, at the coarser of its own point and the common one.
    """
    real = [g * factor for g in GRADIENT]
    points = []
    for n, value in enumerate(real):
        fitting = [p for p in range(frac_limit, -1, -1) if nearest(value * 2**p) < 2 ** (width - 1)]
        if not fitting:
            raise InputError(
                f"segment {n + 1}: gradient {value:g} (Q = {factor:g}) does not fit "
                f"{Fix(width, 0)}, expected below {2 ** (width - 1)}"
            )
        points.append(fitting[0])
    frac = max(points)
    while nearest(max(real) * 2**frac) >= 2**COEFF_WIDTH_LIMIT:
        frac -= 1
    codes = []
    for value, own in zip(real, points, strict=True):
        point = min(own, frac)
        codes.append(nearest(value * 2**point) << (frac - point))
    return codes, frac


def segment_table(precision: Precision, factor: float, reach: int) -> SegmentTable:
    """Constants for one neuron, without the segments that it cannot reach.

    factor: Q of the neuron, 1 where the input is not normalised.
    reach: Largest magnitude code that the neuron can produce.

    A segment that could overflow is refused.
    """
    mag, out, intercept_frac = precision.hidden_fmt, SIGNAL, precision.intercept_frac
    # Thresholds are rounded down: a magnitude code m lies in the segment, m Q / 2**frac <= q_n,
    # just when m is at most floor(q_n 2**frac / Q). Rounding to the nearest code would move the
    # border, by 1 % of q at Q = 512.
    scaled = [floor(Fraction(str(u)) / Fraction(factor) * 2**mag.frac) for u in UPPER]
    kept = max(1, sum(t < min(reach, mag.high) for t in scaled))
    thresholds = scaled[:kept]
    if thresholds != sorted(set(thresholds)):
        raise InputError(
            f"Q = {factor:g}: thresholds {thresholds} coincide in {mag}, expected distinct codes"
        )
    codes, frac = coefficient_codes(factor, precision.coeff_width, precision.gradient_frac_limit)
    intercepts = [nearest(i * 2**intercept_frac) for i in INTERCEPT]
    saturated = kept == len(UPPER)
    words = kept if saturated else kept + 1
    coeffs = codes[:words]
    offsets = intercepts[:words]
    if saturated:
        coeffs.append(0)
        offsets.append(out.high << (intercept_frac - out.frac))
    drop = mag.frac + frac - out.frac
    half = (1 << drop) >> 1 if precision.rounding is Rounding.ROUND else 0
    ends = [*thresholds, min(reach, mag.high)]
    for n, (end, coeff, offset) in enumerate(zip(ends, coeffs, offsets, strict=True)):
        largest = (end * coeff + (offset << (mag.frac + frac - intercept_frac)) + half) >> drop
        if largest > out.high:
            raise InputError(f"segment {n + 1}: largest result {largest} leaves {out} ({out.high})")
    return SegmentTable(tuple(thresholds), tuple(coeffs), frac, tuple(offsets))
