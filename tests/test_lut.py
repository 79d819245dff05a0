"""Tests the look-up table: which word a magnitude reads."""

from fractions import Fraction

import numpy as np
import pytest

from golden.activation.lut import lut_for
from golden.numbers.precision import EXACT, SIGNAL, THESIS

CASES = [(THESIS, q) for q in (1, 2, 3, 7, 12, 77, 100, 511, 512, 3000)] + [(EXACT, 1)]


@pytest.mark.parametrize(("precision", "factor"), CASES, ids=lambda v: getattr(v, "name", v))
def test_every_magnitude_reads_the_word_of_its_step(precision, factor: int) -> None:
    fmt = precision.hidden_fmt
    table = lut_for(precision, factor, fmt.high)
    assert table.scale < 1 << 17
    mags = range(0, fmt.high + 1, 1 if fmt.width == 14 else 7)
    entries = [int(Fraction(m * factor * 256, 7 * 2**fmt.frac)) for m in mags]
    words = np.array([*np.floor(8192 * np.tanh(np.arange(128) * 3.5 / 128) + 0.5), SIGNAL.high])
    assert np.array_equal(table.process(np.array(mags)), words[np.minimum(entries, 128)])


def test_mean_error_of_equation_4_32() -> None:
    """The thesis prints 1.08 %.

    With 128 steps over 0 to 3.5 it is 0.91 %, with steps of 1/32 1.04 %.
    """
    codes = np.arange(SIGNAL.low, SIGNAL.high + 1)
    q = 3 * SIGNAL.to_real(codes)
    error = SIGNAL.to_real(lut_for(THESIS, 3, SIGNAL.high).process(codes)) - np.tanh(q)
    assert 200 * np.abs(error).mean() == pytest.approx(0.907, abs=0.001)
    coarse = np.tanh(np.floor(np.abs(q) * 32) / 32) - np.tanh(np.abs(q))
    assert 200 * np.abs(coarse).mean() == pytest.approx(1.04, abs=0.005)
