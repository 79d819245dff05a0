"""bipartite: tanh from two tables, without a multiplier.

A code m of Fix(18,14) stands for the middle of its step, (m + 1/2) 2**-14, and so does a code of
the result, Fix(15,14). Therefore the magnitude of a negative code is its complement, and one table
of magnitudes, 0 to 131071, gives a function that is odd to the last bit.

Below 2 a segment is 64 codes wide; from 2 on it is four times as wide. Each segment has one base.
A correction belongs to a group of segments with a common slope and to the offset within a segment;
it is an odd function of this offset. The sum of base and correction, without its last bits, is the
result.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from typing import Self

import numpy as np

from golden.activation.activation_block import TABLE_WORDS, ActivationBlock
from golden.activation.scheme import Scheme, require_exact
from golden.common.block import Block
from golden.common.port import CLOCKED, Port, group, input_port, output_port
from golden.numbers.fixed import Codes, Fix, real_texts
from golden.numbers.precision import EXACT, Precision
from golden.numbers.transcendental import tanh_floors
from golden.trained.dense import tanh

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

# A segment below 2 is 2**6 codes wide, and one from 2 on is as many times wider.
SEGMENT_WIDTH = 6
WIDE_WIDTH = SEGMENT_WIDTH + WIDER
# A group is 2**10 codes wide, at least as wide as a segment from 2 on.
GROUP_WIDTH = 10
# Bits of the offset, which are the upper bits of the position within a segment. From 2 on the
# offset has one bit less: the last bit of the address then says whether the magnitude is 4 or more,
# where nothing is corrected.
OFFSET_WIDTH = 5
# Bits that the sum has below the last bit of the result.
FRAC = 3
# Bits of a base, unsigned: those of a magnitude of the result, and ``FRAC``. Each table fills one
# block RAM of 18 Kbit: 1024 bases of 17 bits, and 2048 corrections of 9 bits.
BASE_WIDTH = RESULT.width - 1 + FRAC
# Bits of a base's address below 2, and of a correction's: those of the group, then of the offset.
FINE_ADDR_WIDTH = FINE_WIDTH - SEGMENT_WIDTH
SLOPE_ADDR_WIDTH = FINE_WIDTH - GROUP_WIDTH + OFFSET_WIDTH


def texts(words: Sequence[int]) -> list[str]:
    """The numbers for which bases or corrections stand, as texts."""
    return real_texts(words, RESULT.frac + FRAC)


def addresses(data: Codes, mag: Codes) -> tuple[Codes, Codes]:
    """The addresses of base and correction for a magnitude below 8.

    The offset is taken from ``data`` itself, whose magnitude is ``mag``. For a negative code this
    is the complement of the magnitude's offset, which has the opposite correction.
    """
    below, upper = mag & (1 << FINE_WIDTH) - 1, mag >> FINE_WIDTH
    wide = upper != 0
    switched = np.where(wide, upper, mag >> SEGMENT_WIDTH) & (1 << WIDER) - 1
    base = (below >> WIDE_WIDTH << WIDER) + switched
    ones = (1 << OFFSET_WIDTH) - 1
    fine_offset = data >> (SEGMENT_WIDTH - OFFSET_WIDTH) & ones
    wide_offset = data >> (WIDE_WIDTH - OFFSET_WIDTH) & ones - 1
    offset = np.where(wide, wide_offset + (upper >> 1), fine_offset)
    slope = (below >> GROUP_WIDTH << OFFSET_WIDTH) + offset
    return (wide << FINE_ADDR_WIDTH) + base, (wide << SLOPE_ADDR_WIDTH) + slope


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
        return max(max(self.corrections), -min(self.corrections) - 1).bit_length() + 1


@cache
def bipartite_table() -> BipartiteTable:
    """Compute the words of the tables.

    All steps use integers only. A correction starts as half of the rise of tanh from the mirrored
    offset, in the middle between the segments of its group. A base is the number with the least
    worst error in its segment; errors are counted in units of 2**-6, and among equal ones the base
    with the fewest results that are not the nearest code wins. Then the corrections are chosen for
    these bases in the same way. Finally the bases are chosen once more, each among those with which
    the function does not fall.
    """
    mag = np.arange(1 << MAGNITUDE_WIDTH)
    base_addr, slope_addr = addresses(mag, mag)
    curve = tanh_floors(
        Fraction(1, 2 << EXACT.hidden_fmt.frac), 2 * len(mag), RESULT.frac + _PLACES
    )[1::2]
    bases = np.zeros(2 << FINE_ADDR_WIDTH, dtype=np.int64)
    corrections = np.zeros(2 << SLOPE_ADDR_WIDTH, dtype=np.int64)
    ends = 1 << FINE_WIDTH, 1 << CORRECTED_WIDTH, 1 << MAGNITUDE_WIDTH
    start = before = 0
    for end in ends:
        width = WIDE_WIDTH if start else SEGMENT_WIDTH
        offset_width = OFFSET_WIDTH - (start > 0)
        values = curve[start:end].reshape(
            -1, 1 << (GROUP_WIDTH - width), 1 << offset_width, 1 << (width - offset_width)
        )
        slopes = np.zeros(values.shape[::2], dtype=np.int64)
        if end <= 1 << CORRECTED_WIDTH:
            slopes = _corrections(values)
            slopes = _corrections(values, _bases(values, slopes))
            corrections[slope_addr[start:end]] = _everywhere(slopes[:, np.newaxis, :], values)
        found = _bases(values, slopes, before)
        bases[base_addr[start:end]] = _everywhere(found, values)
        before = int(found[-1, -1] + slopes[-1, -1]) >> FRAC
        start = end
    return BipartiteTable(tuple(bases.tolist()), tuple(corrections.tolist()))


def _everywhere(words: Codes, values: Codes) -> Codes:
    """Repeat each word for all values along the last axes, which the words do not have."""
    shape = words.shape + (1,) * (values.ndim - words.ndim)
    return np.broadcast_to(words.reshape(shape), values.shape).ravel()


def _bases(values: Codes, slopes: Codes, before: int | None = None) -> Codes:
    """Choose a base for each segment.

    values, shape (groups, segments, offsets, codes): tanh in units of the result, with ``_PLACES``
        fraction bits.
    slopes, shape (groups, offsets): The corrections.
    before: The result just before the first value; the function must not fall below it. Without it,
        the function may fall.
    """
    placed = slopes[:, np.newaxis, :, np.newaxis]
    rest = values - (placed << (_PLACES - FRAC))
    middle = (rest.max(axis=(2, 3)) + rest.min(axis=(2, 3))) // 2 >> (_PLACES - FRAC)
    tried = middle + np.arange(-_NEAR, _NEAR + 1)[:, np.newaxis, np.newaxis]
    ranks = np.stack([_rank(values, _wide(t) + placed, (2, 3)) for t in tried])
    if before is None:
        return _least(tried, ranks)
    found = np.zeros(middle.shape, dtype=np.int64)
    for row, segment in np.ndindex(found.shape):
        own = tried[:, row, segment]
        rising = (own + slopes[row, 0]) >> FRAC >= before
        if rising.any():
            found[row, segment] = own[rising][ranks[rising, row, segment].argmin()]
        else:
            found[row, segment] = (before << FRAC) - slopes[row, 0]
        before = int(found[row, segment] + slopes[row, -1]) >> FRAC
    return found


def _corrections(values: Codes, bases: Codes | None = None) -> Codes:
    """Choose a correction for each offset in each group; the parameters are those of ``_bases``.

    Without ``bases`` a correction is half of the rise from the mirrored offset.
    """
    half = values.shape[2] // 2
    upper, lower = values[:, :, half:], values[:, :, half - 1 :: -1]
    middles = ((side.max(axis=3) + side.min(axis=3)) // 2 for side in (upper, lower))
    rise = np.subtract(*middles)
    twice = (rise.max(axis=1) + rise.min(axis=1)) // 2
    shift = _PLACES - FRAC
    found = (twice + (1 << shift)) >> (shift + 1)
    if bases is not None:
        tried = found + np.arange(-_NEAR, _NEAR + 1)[:, np.newaxis, np.newaxis]
        both = np.stack([upper, lower])
        ranks = np.stack(
            [
                _rank(both, _wide(bases) + np.stack([s, -s]), (0, 2, 4))
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


def _rank(values: Codes, sums: Codes, axes: tuple[int, ...]) -> Codes:
    """How bad sums are: first by their largest error, then by how many results are not nearest."""
    results = sums >> FRAC
    apart = np.abs((results << _PLACES) + _ONE // 2 - values).max(axis=axes) >> _COARSE
    wrong = (results != values >> _PLACES).sum(axis=axes)
    return np.asarray((apart << _COUNT_WIDTH) + wrong)


def _least(tried: Codes, ranks: Codes) -> Codes:
    """From the candidates along the first axis, the one with the least rank; else the first."""
    best = ranks.argmin(axis=0)[np.newaxis]
    return np.asarray(np.take_along_axis(tried, best, axis=0)[0])


# The nodes of a pair.
NODES = 2


@dataclass(frozen=True)
class Bipartite(ActivationBlock):
    """r = tanh(q) as the sum of a base and a correction from two tables (Das Sarma, Matula 1995).

    Let the sign s of q be all ones where q is below 0. Then the magnitude is q xor s, and r =
    floor((base(magnitude) xor s) + correction(magnitude, q)).

    in_fmt, out_fmt: Formats of q and r: any format with 14 fraction bits, and Fix(15,14).
    reach_width: Bits of the largest magnitude that the neuron can reach; words beyond it are left
        out. More than 17 where q can reach 8, from where on the result is the largest.

    The function is monotone and, in terms of its codes, odd: the result of a complement is the
    complement of the result. Over all 262144 codes of Fix(18,14) every result is within 0.708 units
    of 2**-13 of tanh(q), and 23416 results are not the nearest code (tests/test_schemes.py).

    A magnitude beyond the neuron's reach gets the result of some other magnitude.
    """

    block = "bipartite"
    half_codes = True
    # The clocks are those of q, which may come straight from an adder; of a block RAM; of its word;
    # and of the sum.
    latency = 4
    reach_width: int

    def __post_init__(self) -> None:
        self.require(
            (self.in_fmt.frac, self.out_fmt) == (EXACT.hidden_fmt.frac, RESULT),
            f"in_fmt={self.in_fmt} and out_fmt={self.out_fmt}",
            f"{EXACT.hidden_fmt.frac} fraction bits and {RESULT}",
        )
        self.check(reach_width=(GROUP_WIDTH + 1, self.in_fmt.width - 1))

    @property
    def table(self) -> BipartiteTable:
        return bipartite_table()

    @property
    def bases(self) -> tuple[int, ...]:
        return self.table.bases[: 1 << (self.reach_width - SEGMENT_WIDTH)]

    @property
    def corrections(self) -> tuple[int, ...]:
        return self.table.corrections[: 1 << (self.reach_width - GROUP_WIDTH + OFFSET_WIDTH)]

    @property
    def wide(self) -> bool:
        """Whether the neuron reaches 2, where the wide segments begin."""
        return self.reach_width > FINE_WIDTH

    @property
    def saturates(self) -> bool:
        """Whether the neuron reaches 8."""
        return self.reach_width > MAGNITUDE_WIDTH

    def taking(self, width: int) -> Self:
        """The same activation for a q of ``width`` bits; every bit counts, and 8 saturates."""
        return replace(
            self,
            in_fmt=Fix(width, self.in_fmt.frac),
            reach_width=width - 1,
            variant=f"block_ram{width - 1}",
        )

    def words_within(self, reach_width: int) -> int:
        """Words of both tables for magnitudes of so many bits."""
        mag = np.arange(1 << reach_width)
        base, slope = addresses(mag, mag)
        return len(np.unique(base)) + len(np.unique(slope))

    def parts_left_out(self) -> Counter[str]:
        reached = self.words_within(min(self.reach_width, MAGNITUDE_WIDTH))
        return +Counter({TABLE_WORDS: self.words_within(MAGNITUDE_WIDTH) - reached})

    @property
    def marks(self) -> tuple[int, ...]:
        widths = FINE_WIDTH, CORRECTED_WIDTH, MAGNITUDE_WIDTH
        return tuple((1 << width) - 1 for width in widths if width < self.reach_width)

    @property
    def word_codes(self) -> Codes:
        """Codes of either sign at which each bit of every word within reach changes the result.

        A low bit that no sum with a word of the other table carries into the result has no such
        code: whatever it is, every result stays the same.
        """
        half = np.arange(1 << min(self.reach_width, MAGNITUDE_WIDTH))
        mag, sign = np.tile(half, 2), np.repeat([0, -1], len(half))
        base_addr, slope_addr = addresses(mag ^ sign, mag)
        base = np.take(self.table.bases, base_addr) ^ sign
        correction = np.take(self.table.corrections, slope_addr)
        flips = [1 << bit for bit in range(self.table.correction_width)]
        # The highest bit of a correction is its sign.
        flips[-1] = -flips[-1]
        changed = [
            *((base_addr, base ^ 1 << bit, correction) for bit in range(BASE_WIDTH)),
            *((slope_addr, base, correction ^ flip) for flip in flips),
        ]
        result = base + correction >> FRAC
        found: list[Codes] = []
        for address, bases, corrections in changed:
            shown = np.flatnonzero(bases + corrections >> FRAC != result)
            found.append(shown[np.unique(address[shown], return_index=True)[1]])
        codes = (mag ^ sign)[np.unique(np.concatenate(found))]
        return np.unique(np.concatenate([codes, ~codes]))

    def quantities(self, *inputs: Codes) -> dict[str, Codes]:
        (data,) = inputs
        return {"magnitude": data ^ (data >> self.in_fmt.width)}

    def compute(self, data: Codes) -> Codes:
        sign = data >> self.in_fmt.width
        whole = data ^ sign
        mag = whole & (1 << min(self.reach_width, MAGNITUDE_WIDTH)) - 1
        # Magnitudes from 8 on are treated like those from 6 on, for all of which the result is the
        # largest.
        mag = np.where(whole >> MAGNITUDE_WIDTH if self.saturates else 0, mag | TOP, mag)
        base_addr, slope_addr = addresses(mag ^ sign, mag)
        base = np.take(self.table.bases, base_addr)
        correction = np.take(self.table.corrections, slope_addr)
        return np.asarray(((base ^ sign) + correction) >> FRAC)


def bipartite_for(precision: Precision, factor: int, reach: int) -> Bipartite:
    """The bipartite activation for a neuron whose magnitudes go up to ``reach``."""
    require_exact("bipartite", precision, factor)
    top = min(reach, precision.hidden_fmt.high)
    reach_width = max(top.bit_length(), GROUP_WIDTH + 1)
    return Bipartite(precision.hidden_fmt, RESULT, reach_width, variant=f"block_ram{reach_width}")


@dataclass(frozen=True)
class BipartitePair(Block):
    """Two nodes share one ``Bipartite`` activation, whose tables have a read port for each."""

    block = "bipartite_pair"
    part_of = "adder_graph"
    area = "activation"
    activation: Bipartite

    @property
    def ports(self) -> tuple[Port, ...]:
        node = self.activation
        return (
            *CLOCKED,
            input_port("in_valid", "`in_data` holds a code of either node"),
            *group(input_port("in_data", "q of node *", node.in_fmt), NODES),
            output_port("out_valid", "`out_data` holds a result of either node"),
            *group(output_port("out_data", "r of node *", node.out_fmt), NODES),
        )

    @property
    def latency(self) -> int:
        return self.activation.latency


SCHEME = Scheme(tanh, bipartite_for, precisions=(EXACT,), half_codes=Bipartite.half_codes)
