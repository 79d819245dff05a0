"""A function of one word as a sum of small tables.

The upper bits of a word address a table of values. What the bits below them add to a value is
nearly the same for neighbouring values, so a few of the highest bits and the lower bits address
further tables, which hold that (bipartite tables, D. Das Sarma and D. W. Matula, 1995). A straight
line needs no high bits there.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import accumulate, pairwise, product

import numpy as np

from golden.numbers.fixed import Codes, Fix, signed_width

# Values that are fitted have so many bits below the last place of a word.
FINE = 8
# The squares of larger errors do not fit their sum.
_MOST_ERROR = 1 << 22
# A function has so many tables at most.
MOST_TABLES = 4
# Bits of the address of the values; those of the other tables, besides as few as there may be. With
# more than six a table takes several LUTs for a bit of its words.
LEAST_TOP, MOST_ADDRESS = 4, 6
ADDRESSES = (4, 5, 6)


@dataclass(frozen=True)
class TablePart:
    """The bits of a word that address a table, counted from the lowest bit of the word.

    top: The highest so many bits.
    high, low: Below those, the bits from ``low`` to ``high``, without ``high``.
    """

    top: int
    high: int = 0
    low: int = 0

    @property
    def width(self) -> int:
        return self.top + self.high - self.low

    def address(self, places: Codes, width: int) -> Codes:
        """The address for words of ``width`` bits, as whole numbers from 0."""
        below = self.high - self.low
        lower = places >> self.low & (1 << below) - 1
        return (places >> width - self.top) << below | lower


@dataclass(frozen=True)
class SmallTable:
    """A table that some bits of a word address.

    source: Which word of a frame.
    words: In the order of the addresses, for bits as they stand in a signal.
    """

    source: int
    part: TablePart
    words: tuple[int, ...]

    @property
    def ends(self) -> tuple[int, int]:
        return min(self.words), max(self.words)

    @property
    def width(self) -> int:
        return max(2, signed_width(self.ends))

    def plus(self, constant: int) -> SmallTable:
        """The same table with a constant added to each word."""
        return replace(self, words=tuple(word + constant for word in self.words))

    def process(self, codes: Codes, fmt: Fix) -> Codes:
        """The words for codes of a format."""
        places = codes & (1 << fmt.width) - 1
        found: Codes = np.array(self.words, dtype=np.int64)[self.part.address(places, fmt.width)]
        return found


def cost(part: TablePart, bits: int) -> float:
    """LUTs of six inputs and half those of four, for words of so many bits and an adder for them.

    A bit that is simpler than others takes fewer.
    """
    return bits * (1 + (1 << max(0, part.width - 4)) / 2 + 1.5)


def bits_of(words: Codes) -> int:
    return signed_width((int(words.min()), int(words.max())))


def tables_of(source: int, values: Codes, tolerance: int) -> tuple[SmallTable, ...]:
    """The cheapest tables whose sum is near to some values, over all codes in the square mean.

    If none are near enough, those that are nearest.

    values: The function at every code of the word, from the least, in units of ``2**-FINE`` of a
        last place.
    tolerance: The largest root mean square of the errors, in the same units.

    Returns: None for a function whose words are all 0.
    """
    kept = _cheapest(values.tobytes(), tolerance)
    return tuple(SmallTable(source, part, words) for part, words in kept)


# Training asks for the same functions again.
@lru_cache(maxsize=1024)
def _cheapest(data: bytes, tolerance: int) -> tuple[tuple[TablePart, tuple[int, ...]], ...]:
    """The parts and the words of ``tables_of``."""
    values = np.frombuffer(data, dtype=np.int64)
    width = len(values).bit_length() - 1
    span = int(values.max() - values.min()) >> FINE
    best: list[tuple[TablePart, Codes]] | None = None
    least = True, 0.0
    for lowest, parts in _ordered(width, span.bit_length() - 1):
        if best is not None and (False, lowest) >= least:
            break
        words, error = fitted(values, parts)
        pairs = [(part, own) for part, own in zip(parts, words, strict=True) if own.any()]
        beyond = error > tolerance**2 * len(values)
        rank = (
            beyond,
            float(error) if beyond else sum(cost(part, bits_of(own)) for part, own in pairs),
        )
        if best is None or rank < least:
            best, least = pairs, rank
    # In the order of the bits in a signal, where the highest is a sign.
    stored = ((p, np.roll(own, len(own) >> 1) if p.top else own) for p, own in best or ())
    return tuple((part, tuple(own.tolist())) for part, own in stored)


@lru_cache(maxsize=256)
def _ordered(width: int, bits: int) -> list[tuple[float, tuple[TablePart, ...]]]:
    """The arrangements with what they cost at least where the values need so many bits."""
    pairs = [
        (cost(parts[0], bits) + sum(cost(part, 1) for part in parts[1:]), parts)
        for parts in arrangements(width)
    ]
    return sorted(pairs, key=lambda pair: pair[0])


def arrangements(width: int) -> Iterator[tuple[TablePart, ...]]:
    """The parts that tables of words of so many bits may have; the first one has the values."""
    if width <= MOST_ADDRESS:
        yield (TablePart(width),)
    for top in range(min(LEAST_TOP, width - 1), min(MOST_ADDRESS, width - 1) + 1):
        for counts in _splits(width - top, MOST_TABLES - 1):
            ends = [width - top, *(width - top - cut for cut in accumulate(counts))]
            choices = [
                sorted({min(top, max(0, address - count)) for address in ADDRESSES} | {0})
                for count in counts
            ]
            for highs in product(*choices):
                # The lower a bit, the less what it adds differs from place to place.
                if all(
                    a + m >= b + n for (a, m), (b, n) in pairwise(zip(highs, counts, strict=True))
                ):
                    yield TablePart(top), *map(TablePart, highs, ends, ends[1:])


def _splits(bits: int, most: int) -> Iterator[tuple[int, ...]]:
    """The ways to split so many bits into groups, at most so many, each of which has an address."""
    if bits <= MOST_ADDRESS:
        yield (bits,)
    if most > 1:
        for first in range(1, min(bits, MOST_ADDRESS + 1)):
            for rest in _splits(bits - first, most - 1):
                yield first, *rest


def fitted(values: Codes, parts: Sequence[TablePart]) -> tuple[list[Codes], int]:
    """The words of tables with these parts whose sum is near to some values.

    The sum of the squares of the errors comes with them.

    The values are those of ``tables_of``. Everything is computed in whole numbers.
    """
    width = len(values).bit_length() - 1
    addresses = [_addresses(part, width) for part in parts]
    rest, words = values.copy(), []
    for part, address in zip(parts, addresses, strict=True):
        # The mean of the values of each address. Sums of so few small whole numbers are exact in
        # floating point.
        sums = np.bincount(address, rest, 1 << part.width)
        words.append(np.floor(sums * (1 << part.width) / len(rest)).astype(np.int64))
        rest -= words[-1][address]
    for own, address in zip(words[1:], addresses[1:], strict=True):
        rest += own[address]
        own[:] = _rounded(own)
        # As many words above 0 as below, so that they have few bits; the values take the rest.
        own -= (own.min() + own.max() + 1) >> 1
        rest -= own[address] << FINE
    first, address = words[0], addresses[0]
    rest += first[address]
    groups = rest.reshape(len(first), -1)
    first[:] = _rounded((groups.min(axis=1) + groups.max(axis=1)) >> 1)
    rest -= first[address] << FINE
    return words, int((rest.clip(-_MOST_ERROR, _MOST_ERROR) ** 2).sum())


def _rounded(words: Codes) -> Codes:
    """Whole words from those in units of ``2**-FINE``."""
    found: Codes = (words + (1 << FINE - 1)) >> FINE
    return found


@lru_cache(maxsize=1024)
def _addresses(part: TablePart, width: int) -> Codes:
    """The address for each code of a word, from the least."""
    return part.address(np.arange(1 << width), width)
