"""The words of ``bipartite``: a base for each segment of tanh, and a correction within it.

A code m of Fix(18,14) stands for the middle of its step, (m + 1/2) 2**-14, and so does a code of
the result, Fix(15,14). Therefore the magnitude of a negative code is its complement, and one table
of magnitudes, 0 to 131071, gives a function that is odd to the last bit.

Below 2 a segment is 2**w codes wide; from 2 on it is four times as wide. Each segment has one base.
A correction belongs to a group of segments with a common slope and to the offset within a segment;
it is an odd function of this offset. The sum of base and correction, without its last bits, is the
result.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

import numpy as np

from golden.numbers.fixed import Codes, Fix, real_texts
from golden.numbers.precision import EXACT
from golden.numbers.transcendental import tanh_floors

# One place more than a sample has. With those of a sample, rounding r would be most of the error of
# a network.
RESULT = Fix(15, 14)
# Bits of a magnitude below 2, below 4 and below 8.
FINE_WIDTH = EXACT.hidden_fmt.frac + 1
CORRECTED_WIDTH = FINE_WIDTH + 1
MAGNITUDE_WIDTH = EXACT.hidden_fmt.width - 1
# A wide segment is 2**2 fine ones. The two bits that say where beyond 2 a magnitude lies replace
# the two address bits that a wide segment does not need.
WIDER = MAGNITUDE_WIDTH - FINE_WIDTH
# The bits that every magnitude from 6 on has set.
TOP = 3 << FINE_WIDTH

# Fraction bits of the tanh that is approximated, in units of the result.
_PLACES = 16
_ONE = 1 << _PLACES
# How far from its first guess the search goes, in last places of a word.
_NEAR = 4
# Errors are compared in units of 2**-6; among equal ones the number of wrong results decides.
_COARSE = _PLACES - 6
_COUNT_WIDTH = 24


@dataclass(frozen=True)
class BipartiteFormat:
    """Segments, groups and formats of one variant of the tables.

    segment_width: w: a segment below 2 is 2**w codes wide.
    group_width: A group is 2**group_width codes wide, at least as wide as a segment beyond 2.
    offset_width: Bits of the offset, which are the upper bits of the position within a segment.
        From 2 on the offset has one bit less: the last bit of the address then says whether the
        magnitude is 4 or more, where nothing is corrected.
    frac: Bits that the sum has below the last bit of the result.
    """

    segment_width: int
    group_width: int
    offset_width: int
    frac: int

    @property
    def wide_width(self) -> int:
        """Base-2 logarithm of the width of a segment from 2 on, in codes."""
        return self.segment_width + WIDER

    @property
    def base_width(self) -> int:
        """Bits of a base, unsigned: those of a magnitude of the result, plus ``frac``."""
        return RESULT.width - 1 + self.frac

    @property
    def fine_addr_width(self) -> int:
        """Bits of a base's address below 2."""
        return FINE_WIDTH - self.segment_width

    @property
    def slope_addr_width(self) -> int:
        """Bits of a correction's address below 2: those of the group, then those of the offset."""
        return FINE_WIDTH - self.group_width + self.offset_width

    def texts(self, words: Sequence[int]) -> list[str]:
        """The numbers for which bases or corrections stand, as texts."""
        return real_texts(words, RESULT.frac + self.frac)

    def addresses(self, data: Codes, mag: Codes) -> tuple[Codes, Codes]:
        """The addresses of base and correction for a magnitude below 8.

        The offset is taken from ``data`` itself, whose magnitude is ``mag``. For a negative code
        this is the complement of the magnitude's offset, which has the opposite correction.
        """
        below, upper = mag & (1 << FINE_WIDTH) - 1, mag >> FINE_WIDTH
        wide = upper != 0
        switched = np.where(wide, upper, mag >> self.segment_width) & (1 << WIDER) - 1
        base = (below >> self.wide_width << WIDER) + switched
        ones = (1 << self.offset_width) - 1
        fine_offset = data >> (self.segment_width - self.offset_width) & ones
        wide_offset = data >> (self.wide_width - self.offset_width) & ones - 1
        offset = np.where(wide, wide_offset + (upper >> 1), fine_offset)
        slope = (below >> self.group_width << self.offset_width) + offset
        return (wide << self.fine_addr_width) + base, (wide << self.slope_addr_width) + slope


# Each table fills one block RAM of 18 Kbit: 1024 bases of 17 bits, and 2048 corrections of 9 bits.
BLOCK_RAM = BipartiteFormat(6, 10, 5, 3)
LOGIC = BipartiteFormat(8, 10, 4, 0)
FORMATS = {"block_ram": BLOCK_RAM, "logic": LOGIC}


@dataclass(frozen=True)
class BipartiteTable:
    """The words of both tables, by address.

    bases: Unsigned. An address that no magnitude has holds 0.
    corrections: Signed; 0 for magnitudes from 4 on.
    """

    bases: tuple[int, ...]
    corrections: tuple[int, ...]

    @property
    def correction_width(self) -> int:
        """Bits of a correction, which is signed."""
        return max(max(self.corrections), -min(self.corrections) - 1).bit_length() + 1


@lru_cache
def bipartite_table(fmt: BipartiteFormat) -> BipartiteTable:
    """Compute the words of a variant of the tables.

    All steps use integers only. A correction starts as half of the rise of tanh from the mirrored
    offset, in the middle between the segments of its group. A base is the number with the least
    worst error in its segment; errors are counted in units of 2**-6, and among equal ones the base
    with the fewest results that are not the nearest code wins. Then the corrections are chosen for
    these bases in the same way. Finally the bases are chosen once more, each among those with which
    the function does not fall.
    """
    mag = np.arange(1 << MAGNITUDE_WIDTH)
    base_addr, slope_addr = fmt.addresses(mag, mag)
    curve = tanh_floors(
        Fraction(1, 2 << EXACT.hidden_fmt.frac), 2 * len(mag), RESULT.frac + _PLACES
    )[1::2]
    bases = np.zeros(2 << fmt.fine_addr_width, dtype=np.int64)
    corrections = np.zeros(2 << fmt.slope_addr_width, dtype=np.int64)
    ends = 1 << FINE_WIDTH, 1 << CORRECTED_WIDTH, 1 << MAGNITUDE_WIDTH
    start = before = 0
    for end in ends:
        width = fmt.wide_width if start else fmt.segment_width
        offset_width = fmt.offset_width - (start > 0)
        values = curve[start:end].reshape(
            -1, 1 << (fmt.group_width - width), 1 << offset_width, 1 << (width - offset_width)
        )
        slopes = np.zeros(values.shape[::2], dtype=np.int64)
        if end <= 1 << CORRECTED_WIDTH:
            slopes = _corrections(values, fmt.frac)
            slopes = _corrections(values, fmt.frac, _bases(values, fmt.frac, slopes))
            corrections[slope_addr[start:end]] = _everywhere(slopes[:, np.newaxis, :], values)
        found = _bases(values, fmt.frac, slopes, before)
        bases[base_addr[start:end]] = _everywhere(found, values)
        before = int(found[-1, -1] + slopes[-1, -1]) >> fmt.frac
        start = end
    return BipartiteTable(tuple(bases.tolist()), tuple(corrections.tolist()))


def _everywhere(words: Codes, values: Codes) -> Codes:
    """Repeat each word for all values along the last axes, which the words do not have."""
    shape = words.shape + (1,) * (values.ndim - words.ndim)
    return np.broadcast_to(words.reshape(shape), values.shape).ravel()


def _bases(values: Codes, frac: int, slopes: Codes, before: int | None = None) -> Codes:
    """Choose a base for each segment.

    values, shape (groups, segments, offsets, codes): tanh in units of the result, with ``_PLACES``
        fraction bits.
    frac: Fraction bits of the bases.
    slopes, shape (groups, offsets): The corrections.
    before: The result just before the first value; the function must not fall below it. Without it,
        the function may fall.
    """
    placed = slopes[:, np.newaxis, :, np.newaxis]
    rest = values - (placed << (_PLACES - frac))
    middle = (rest.max(axis=(2, 3)) + rest.min(axis=(2, 3))) // 2 >> (_PLACES - frac)
    tried = middle + np.arange(-_NEAR, _NEAR + 1)[:, np.newaxis, np.newaxis]
    ranks = np.stack([_rank(values, _wide(t) + placed, frac, (2, 3)) for t in tried])
    if before is None:
        return _least(tried, ranks)
    found = np.zeros(middle.shape, dtype=np.int64)
    for group, segment in np.ndindex(found.shape):
        own = tried[:, group, segment]
        rising = (own + slopes[group, 0]) >> frac >= before
        if rising.any():
            found[group, segment] = own[rising][ranks[rising, group, segment].argmin()]
        else:
            found[group, segment] = (before << frac) - slopes[group, 0]
        before = int(found[group, segment] + slopes[group, -1]) >> frac
    return found


def _corrections(values: Codes, frac: int, bases: Codes | None = None) -> Codes:
    """Choose a correction for each offset in each group; the parameters are those of ``_bases``.

    Without ``bases`` a correction is half of the rise from the mirrored offset.
    """
    half = values.shape[2] // 2
    upper, lower = values[:, :, half:], values[:, :, half - 1 :: -1]
    middles = ((side.max(axis=3) + side.min(axis=3)) // 2 for side in (upper, lower))
    rise = np.subtract(*middles)
    twice = (rise.max(axis=1) + rise.min(axis=1)) // 2
    shift = _PLACES - frac
    found = (twice + (1 << shift)) >> (shift + 1)
    if bases is not None:
        tried = found + np.arange(-_NEAR, _NEAR + 1)[:, np.newaxis, np.newaxis]
        both = np.stack([upper, lower])
        ranks = np.stack(
            [
                _rank(both, _wide(bases)[:, :, :] + np.stack([s, -s]), frac, (0, 2, 4))
                for s in tried[:, :, np.newaxis, :, np.newaxis]
            ]
        )
        found = _least(tried, ranks)
    # The corrections rise from the middle on, so that the function does not fall within a segment.
    found = np.maximum.accumulate(np.maximum(found, 0), axis=1)
    return np.concatenate([-found[:, ::-1], found], axis=1)


def _wide(bases: Codes) -> Codes:
    """The bases with the axes of the values."""
    return bases[:, :, np.newaxis, np.newaxis]


def _rank(values: Codes, sums: Codes, frac: int, axes: tuple[int, ...]) -> Codes:
    """How bad sums are: first by their largest error, then by how many results are not nearest."""
    results = sums >> frac
    apart = np.abs((results << _PLACES) + _ONE // 2 - values).max(axis=axes) >> _COARSE
    wrong = (results != values >> _PLACES).sum(axis=axes)
    return np.asarray((apart << _COUNT_WIDTH) + wrong)


def _least(tried: Codes, ranks: Codes) -> Codes:
    """From the candidates along the first axis, the one with the least rank; else the first."""
    best = ranks.argmin(axis=0)[np.newaxis]
    return np.asarray(np.take_along_axis(tried, best, axis=0)[0])
