"""Extreme cases of the activations: the most negative code, and a regression that diverges."""

from collections.abc import Iterator

import numpy as np

from golden.activation.abs_unit import AbsUnit
from golden.activation.pade import GATE, pade_real
from golden.activation.reference import rho_regression, stable_below
from golden.activation.schemes import SCHEMES, forms
from golden.numbers.fixed import Codes, Fix
from golden.numbers.precision import EXACT, SIGNAL, THESIS
from studies.stability.case import Row, largest
from tactus.report.measure.activation_errors import built

FACTORS = (1, 5, 512)
# With these, the regression settles only up to |q| of 1.447 and 2.371.
SMALL_RHOS = (1.0, 2.0)
RHOS = "rho = 1 and 2"
ITERATIONS = (2, 3, 41, 200)


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
    grown = min(float(abs(rho_regression(0.99 * GATE, rho, most))) for rho in SMALL_RHOS)
    ends = " and ".join(f"{stable_below(rho):.3f}" for rho in SMALL_RHOS)
    case = f"{RHOS}, {most} iterations, settles below |q| = {ends} only"
    yield Row("pade", case, "diverge without saturation", "1 / |r|", 1 / grown, 1e-6)
