"""Extreme cases of the activations and of the load profile."""

from collections.abc import Iterator

import numpy as np

from golden.activation.abs_unit import AbsUnit
from golden.activation.pade import GATE, fraction, pade_real, stable_below
from golden.activation.schemes import SCHEMES, forms
from golden.numbers.fixed import Codes, Fix
from golden.numbers.precision import EXACT, SIGNAL, THESIS
from golden.numbers.real import Real
from golden.visualisation.load_profile import RECTANGLE, LoadProfile, load_profile, power_load
from studies.stability.case import Row, largest, worst
from studies.stability.digits import DIGITS, harmonic_sum
from tactus.report.activations import built

FACTORS = (1, 5, 512)
# With these, the regression settles only up to |q| of 1.447 and 2.371.
SMALL_RHOS = (1.0, 2.0)
RHOS = "rho = 1 and 2"
ITERATIONS = (2, 3, 41, 200)
# The bound of the error of LoadProfile over every quotient.
PROFILE_ERROR = 1.81
# How much the rounding of 3.17 may be, for loads up to 1.
ROUNDING = 1e-12
TERMS = 10_000
# The integral of sin(x) / x from 0 to pi.
WILBRAHAM_GIBBS = 1.8519370519824661


def _every_code(fmt: Fix) -> Codes:
    return np.arange(fmt.low, fmt.high + 1)


def most_negative() -> Iterator[Row]:
    """The code of -1, through ABS and through every activation."""
    for precision in (THESIS, EXACT):
        fmt = precision.hidden_fmt
        mag, negative = AbsUnit(fmt).process(_every_code(fmt))
        off = largest(mag[0] - fmt.high, not negative[0])
        case = f"{fmt.to_real(fmt.low):g} in {fmt}"
        must = "give the largest code: saturate, not wrap"
        yield Row("abs_unit", case, must, "codes off", off, 0)
        off = largest(mag[1:] - np.abs(_every_code(fmt)[1:]))
        yield Row("abs_unit", f"every other code of {fmt}", "be exact", "codes off", off, 0)
    for name, scheme in forms().items():
        for precision in scheme.precisions:
            fmt = precision.hidden_fmt
            ends = np.array([fmt.low, fmt.high])
            blocks = [
                built(scheme, precision, factor)
                for factor in (FACTORS if precision.normalise else (1,))
            ]
            found = np.array([block.real_result(block.compute(ends)) for block in blocks])
            skew = largest(np.ldexp(found.sum(axis=1), SIGNAL.frac))
            case = f"most negative code, {precision.name}"
            must = "give the negative of the largest code's result"
            yield Row(name, case, must, "codes off", skew, 0)


def divergence() -> Iterator[Row]:
    """Pade with such a small rho that its regression diverges below the gate."""
    for precision, factor in ((THESIS, 5), (EXACT, 1)):
        fmt = precision.hidden_fmt
        codes = _every_code(fmt)
        q = factor * fmt.to_real(codes)
        beyond = np.abs(q) > GATE
        blocks = [
            built(SCHEMES["pade"].configured({"rho": rho, "iterations": n}), precision, factor)
            for rho in SMALL_RHOS
            for n in ITERATIONS
        ]
        found = np.array([block.compute(codes) for block in blocks])
        ends = f"{min(ITERATIONS)} to {max(ITERATIONS)} iterations"
        case = f"{RHOS}, {ends}, {precision.name}"
        off = largest(np.abs(found[:, beyond]) - SIGNAL.high)
        must = "give the largest code beyond the gate"
        yield Row("pade", case, must, "codes off", off, 0)
        wrong = int((found * np.sign(codes) < 0).sum())
        yield Row("pade", case, "keep the sign", "wrong signs", wrong, 0)
        yield Row("pade", case, "stay in the format", "code", largest(found), SIGNAL.high)
    q = np.linspace(-8, 8, 4001)
    most = max(ITERATIONS)
    values = [pade_real(q, rho, most)[0] for rho in SMALL_RHOS]
    case = f"{RHOS}, {most} iterations, floating point"
    yield Row("pade", case, "stay in -1 to 1", "value", largest(*values), 1)
    # Without the gate, which the rows above test, the regression leaves every format.
    grown = min(abs(_regression(0.99 * GATE, rho, most)) for rho in SMALL_RHOS)
    ends = " and ".join(f"{stable_below(rho):.3f}" for rho in SMALL_RHOS)
    case = f"{RHOS}, {most} iterations, settles below |q| = {ends} only"
    yield Row("pade", case, "diverge without saturation", "1 / |r|", 1 / grown, 1e-6)


def _regression(q: float, rho: float, iterations: int) -> float:
    """Equations 4.10 to 4.12: d <- 1 / rho - d (B - rho) / rho from 0, times q A."""
    a, b = map(float, fraction(np.array(q)))
    d = 0.0
    for _ in range(iterations):
        d = 1 / rho - d * (b - rho) / rho
    return q * a * d


def narrow_loads() -> Iterator[Row]:
    """Equation 3.18 with widths down to one code and below, P = 6."""
    design = load_profile()
    gain = design.divider.gain / 2**design.divider.gain_frac
    # These lie next to every drawn position, and far from all of them.
    beside = np.add.outer(design.ramp.process(), np.arange(-20, 21)).ravel()
    centres = [*beside[beside >= 0], *range(SIGNAL.low, SIGNAL.high + 1, 61)]
    for widths in ((SIGNAL.low, 0, 1), (3,), (30,), (300,)):
        narrow = max(widths)
        power = (gain * 2**SIGNAL.frac / narrow) ** RECTANGLE
        case = f"P = 6, width of {' or '.join(map(str, widths))} codes, C^P = {power:.1e}"
        loads = np.array([SIGNAL.low, SIGNAL.high])
        frames = np.array([[d, i, width, 0] for width in widths for d in loads for i in centres])
        exact = design.real(frames)
        error = 2**SIGNAL.frac * largest(SIGNAL.to_real(design.process(frames)[1]) - exact)
        must = "keep the bound of every quotient"
        yield Row("load_profile", case, must, "error in 2^-13", error, PROFILE_ERROR)
        over = largest(np.maximum(np.abs(design.process(frames)[1]) - np.abs(frames[:, [0]]), 0))
        yield Row("load_profile", case, "not exceed the load", "codes beyond", over, 0)
    yield from _fold(design)
    _, profile = design.process([[SIGNAL.high, SIGNAL.low, 1, 0]])
    far = largest(profile)
    yield Row("load_profile", "one code wide, far away", "be flat", "code", far, 0)
    at = np.array([-1.0, 0.5, np.nextafter(0.5, 1), 1.0])
    off = largest(power_load(at, 1.0, 0.5, 1e300, RECTANGLE) - [0, 1, 0, 0])
    must = "be d at the centre, 0 beside it"
    yield Row("equation 3.18", "C = 1e300, P = 6", must, "error / d", off, 0)


def _fold(design: LoadProfile) -> Iterator[Row]:
    """power_fold and divider over all inputs that they can get."""
    fold = design.power_fold
    t = np.arange(1 << fold.in_width)
    found = fold.process(t, np.asarray(RECTANGLE)) / 2**fold.out_frac
    exact = (t / 2**fold.in_frac) ** RECTANGLE
    top = 2.0 ** (fold.out_width - fold.out_frac)
    error = 2**fold.out_frac * np.abs(found - np.minimum(exact, top))
    # Each step adds half an LSB, which the next step multiplies by t, for t up to the value at
    # which t^6 saturates. One more LSB is the distance of the largest code from the end of the
    # range.
    bound = (top - 1) / (top ** (1 / RECTANGLE) - 1) / 2 + 1
    must = "saturate where t^6 does"
    yield Row("power_fold", "P = 6, every t", must, "error in LSB", float(error.max()), bound)
    falls = max(0, -int(np.diff(found * 2**fold.out_frac).min()))
    yield Row("power_fold", "P = 6, every t", "never fall", "largest fall in LSB", falls, 0)
    cut = design.divider
    ends = [0, 1, (1 << cut.distance_width) - 1]
    off = 0
    for distance in ends:
        for width in (0, 1, 2, (1 << cut.width_width) - 1):
            quotient = (distance * cut.gain << (cut.out_frac - cut.gain_frac)) // max(width, 1)
            exact_code = min(quotient, (1 << cut.out_width) - 1)
            off = max(off, abs(int(cut.process(distance, width)) - exact_code))
    must = "equal exact integers, saturated"
    yield Row("divider", "width of 0 and 1, largest distance", must, "codes off", off, 0)


def harmonic_load(position: Real, d: float, centre: float, width: float, terms: int) -> Real:
    """Equation 3.17: 4 d sum over m of sin(m w pi) cos(m i_m pi) cos(m i_p pi) / (m pi).

    The thesis prints 1 / (n pi). There n is not defined, and only m gives its Figure 3.27. The
    pulse of height d reaches from i_m - w to i_m + w, in 0 to 1. The sum has no constant term, so
    its mean is 0: it is d (1 - 2 w) on the pulse and -2 d w beside it.

    Near a jump the sum overshoots by 0.0895 d, however many terms it has (Gibbs). Phases are
    reduced to one turn before the sine is computed.
    """
    m = np.arange(1.0, terms + 1).reshape(-1, *[1] * np.ndim(position))
    sine = np.sin(np.pi * np.remainder(m * width, 2))
    cosines = (np.cos(np.pi * np.remainder(m * x, 2)) for x in (centre, position))
    product: Real = sine * next(cosines) * next(cosines) / (m * np.pi)
    return 4 * d * product.sum(axis=0)


def _phases(p: Real, c: float, w: float) -> Real:
    """The four sawtooth arguments of equation 3.17, in units of pi, along a new first axis.

    They are those of the pulse, and of its mirror images at both ends of the beam.
    """
    return np.remainder(np.stack([w + (p - c), w - (p - c), w + (p + c), w - (p + c)]), 2)


def harmonic_limit(position: Real, d: float, centre: float, width: float) -> Real:
    """The limit of equation 3.17 for an infinite number of terms, in closed form.

    A product of one sine and two cosines is a sum of four sines, and the sum over m of
    sin(m pi x) / (m pi) is the sawtooth (1 - x) / 2 for 0 < x < 2, 0 at x = 0, of period 2.
    """
    x = _phases(position, centre, width)
    result: Real = d * np.where(x == 0, 0.0, (1 - x) / 2).sum(axis=0)
    return result


def harmonic_tail(position: Real, d: float, centre: float, width: float, terms: int) -> Real:
    """A bound of ``|harmonic_load - harmonic_limit|``, that is of the terms that are left out.

    By Abel's summation the terms beyond P of sum sin(m theta) / m stay below
    ``1 / ((P + 1) |sin(theta / 2)|)``, and partial sums and limit lie between 0 and
    the Wilbraham-Gibbs constant on either side of 0, so the tail never exceeds that. At a jump
    (theta = 0) every term is 0, and so is the bound.
    """
    x = _phases(position, centre, width)
    with np.errstate(divide="ignore", over="ignore"):
        tails = np.minimum(1 / ((terms + 1) * np.sin(np.pi * x / 2)), WILBRAHAM_GIBBS)
    result: Real = abs(d) * np.where(x == 0, 0.0, tails).sum(axis=0) / np.pi
    return result


def jumps() -> Iterator[Row]:
    """Equation 3.17 at both of its jumps, next to them, and away from them."""
    places, pulse = np.array([0.2, 0.8]), (0.5, 0.5, 0.3)
    must = "keep the bound of the terms left out"
    for case, distances in (
        ("0 to 1e-06 from its jumps", (0.0, 1e-15, 1e-12, 1e-6)),
        ("0.05 from its jumps", (0.05,)),
    ):
        at = np.add.outer(places, np.outer([-1, 1], distances)).ravel()
        for terms in (1, TERMS):
            found = harmonic_load(at, *pulse, terms)
            error = found - harmonic_limit(at, *pulse)
            pair = worst(error, harmonic_tail(at, *pulse, terms) + ROUNDING)
            yield Row("equation 3.17", f"{case}, {terms} terms", must, "error", *pair)
        off = largest(found - [harmonic_sum(float(x), *pulse, TERMS) for x in at])
        must_agree = f"agree with {DIGITS} digits"
        yield Row("equation 3.17", f"{case}, {TERMS} terms", must_agree, "error", off, ROUNDING)
