"""Extreme cases of the activations and of the load profile."""

from collections.abc import Iterator

import numpy as np

from golden.activation.abs_unit import AbsUnit
from golden.activation.pade import GATE, fraction, pade_real, stable_below
from golden.activation.schemes import SCHEMES, forms
from golden.numbers.fixed import Codes, Fix
from golden.numbers.precision import EXACT, SIGNAL, THESIS
from golden.visualisation.load_profile import RECTANGLE, load_profile, power_load
from studies.stability.case import Row, largest
from tactus.report.activations import built

FACTORS = (1, 5, 512)
# With these, the regression settles only up to |q| of 1.447 and 2.371.
SMALL_RHOS = (1.0, 2.0)
RHOS = "rho = 1 and 2"
ITERATIONS = (2, 3, 41, 200)
# The bound of the error of LoadProfile over every quotient.
PROFILE_ERROR = 1.81


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
    _, profile = design.process([[SIGNAL.high, SIGNAL.low, 1, 0]])
    far = largest(profile)
    yield Row("load_profile", "one code wide, far away", "be flat", "code", far, 0)
    at = np.array([-1.0, 0.5, np.nextafter(0.5, 1), 1.0])
    off = largest(power_load(at, 1.0, 0.5, 1e300, RECTANGLE) - [0, 1, 0, 0])
    must = "be d at the centre, 0 beside it"
    yield Row("equation 3.18", "C = 1e300, P = 6", must, "error / d", off, 0)
