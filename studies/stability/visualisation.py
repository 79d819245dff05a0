"""Extreme cases of the visualisation: very narrow loads, and the jumps of equation 3.17."""

from collections.abc import Iterator

import numpy as np

from golden.numbers.precision import SIGNAL
from golden.visualisation.functions import (
    harmonic_limit,
    harmonic_load,
    harmonic_tail,
    power_load,
)
from golden.visualisation.load_profile import RECTANGLE, LoadProfile, load_profile
from studies.stability.case import Row, largest, worst
from studies.stability.digits import DIGITS, harmonic_sum

# The bound of the error of LoadProfile over every quotient.
PROFILE_ERROR = 1.81
# What harmonic_load promises of its rounding, for loads up to 1.
ROUNDING = 1e-12
TERMS = 10_000


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
