"""The look-up table activation: tanh from a table of 128 values."""

from collections import Counter
from dataclasses import dataclass
from fractions import Fraction
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.activation.activation_block import COMPARATORS, TABLE_WORDS, Compared
from golden.activation.scheme import Scheme
from golden.activation.segments import last_below
from golden.input_error import InputError
from golden.numbers.fixed import Codes, Rounding, cut
from golden.numbers.precision import SIGNAL, Precision
from golden.numbers.transcendental import tanh_floors

DEPTH = 128
UPPER = 3.5


def lut_real(q: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The look-up table in floating point, and a slope for gradient descent.

    Returns value, slope, the shape of ``q``: A staircase has no slope. The slope here is that of
        the rise from one step to the next.
    """
    real = np.asarray(q, dtype=np.float64)
    step = UPPER / DEPTH
    entry = np.floor(np.abs(real) / step)
    beyond = entry >= DEPTH
    value = np.where(beyond, 1.0, np.tanh(entry * step))
    slope = np.where(beyond, 0.0, (np.tanh((entry + 1) * step) - np.tanh(entry * step)) / step)
    return np.where(real < 0, -value, value), slope


@dataclass(frozen=True)
class Lut(Compared):
    """r = tanh(Q qbar), read from a table (thesis section 4.5.2.3.4).

    Word n holds tanh(3.5 n / 128) and stands for 3.5 n / 128 <= q < 3.5 (n + 1) / 128; from 3.5 on
    the result is 1 - 2**-frac.

    words: Codes of ``out_fmt``, as many as the neuron can reach.
    scale, scale_shift: The address of magnitude code m is floor(m * scale / 2**scale_shift).
    thresholds: The last magnitude code below 3.5, where the neuron can exceed it; otherwise empty.

    A magnitude beyond the neuron's reach reads some word of the table.
    """

    block = "lut"
    section = "4.5.2.3.4"
    words: tuple[int, ...]
    scale: int
    scale_shift: int
    thresholds: tuple[int, ...]

    @property
    def addr_width(self) -> int:
        return max(1, (len(self.words) - 1).bit_length())

    @property
    def latency(self) -> int:
        # The address is computed beside the comparator bank; the word takes one clock more.
        return sum(part.latency for part in self.parts()) + 1

    def parts_left_out(self) -> Counter[str]:
        words, comparators = DEPTH - len(self.words), 1 - len(self.thresholds)
        return +Counter({TABLE_WORDS: words, COMPARATORS: comparators})

    @property
    def marks(self) -> tuple[int, ...]:
        first = (np.arange(1, len(self.words)) << self.scale_shift) // -self.scale
        last = -first - 1
        return (*last[last < self.abs_unit.fmt.high].tolist(), *self.thresholds)

    def compute(self, data: Codes) -> Codes:
        mag, negative = self.abs_unit.process(data)
        beyond = self.comparator_bank.process(mag)
        addr = (mag * self.scale >> self.scale_shift) & ((1 << self.addr_width) - 1)
        word = np.take(self.words, np.minimum(addr, len(self.words) - 1))
        return self.sign_retriever.process(np.where(beyond, self.out_fmt.high, word), negative)


@cache
def _words() -> tuple[int, ...]:
    """The words of the whole table, rounded to nearest."""
    floors = tanh_floors(Fraction(UPPER) / DEPTH, DEPTH, SIGNAL.frac + 1)
    return tuple(cut(floors, 1, Rounding.ROUND).tolist())


def lut_for(precision: Precision, factor: int, reach: int) -> Lut:
    """The look-up table for a neuron normalised by ``factor`` with magnitudes to ``reach``."""
    fmt = precision.hidden_fmt
    end = last_below(str(UPPER), factor, fmt.frac)
    top = min(reach, fmt.high)
    if end < 1:
        raise InputError(f"Q = {factor}: {UPPER} / Q is not above one code of {fmt}")
    # The number of table entries per code, as an exact fraction. Below the end of the table an
    # address is below DEPTH.
    entries = Fraction(factor * DEPTH, 1 << fmt.frac) / Fraction(UPPER)
    count = min(DEPTH, int(top * entries) + 1)
    last = min(end, -(-count // entries) - 1)
    # The reciprocal is rounded up by e = scale denominator - numerator 2**shift. The floor is exact
    # for every m up to last when m e stays below 2**shift. That needs 17 bits at most, because
    # 2**shift <= 2 last denominator, hence scale <= 2 last numerator, for last below 3.5 / Q.
    shift = 0
    while True:
        scale = -(-(entries.numerator << shift) // entries.denominator)
        excess = scale * entries.denominator - (entries.numerator << shift)
        if last * excess < 1 << shift:
            break
        shift += 1
    beyond = (end,) if end < top else ()
    return Lut(
        fmt,
        SIGNAL,
        _words()[:count],
        scale,
        shift,
        beyond,
        variant=f"q{factor}w{count + len(beyond)}",
    )


SCHEME = Scheme(lut_real, lut_for)
