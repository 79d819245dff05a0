"""How many LUTs of four inputs a table in logic takes, counted from the bits of its words.

Each bit of the words is a function of the address. A function of four address bits is a LUT. One of
more is split by the address bits that choose between its LUTs; those bits are taken that leave the
fewest. The choice between two LUTs is a wide multiplexer of their slice and takes no LUT. One of
more does not always fit there; how many LUTs it takes is fitted.
"""

from collections.abc import Iterable
from functools import lru_cache
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

# Inputs of a LUT.
INPUTS = 4
Bits = NDArray[np.bool_]
# A function of an address at each address, whose bits are 0 or 1.
Column = tuple[int, ...]


def bit_columns(words: Iterable[int], width: int) -> list[Column]:
    """The different bits of the words of a table as functions of its address, none constant.

    At addresses without a word the last one stands.
    """
    known = list(words)
    known += known[-1:] * ((1 << (len(known) - 1).bit_length()) - len(known))
    found = np.array(known, dtype=object)
    columns = {tuple((found >> bit & 1).tolist()) for bit in range(width)}
    return [one for one in sorted(columns) if len(set(one)) > 1]


# The same tables stand in graphs with other registers.
@lru_cache(maxsize=4096)
def luts_of(column: Column) -> tuple[int, int]:
    """The LUTs of a function of an address, and 1 if more than two LUTs are chosen between, else 0.

    A function that is a bit of the address takes none.
    """
    bits = len(column).bit_length() - 1
    reduced = _needed(np.array(column, dtype=bool).reshape((2,) * bits))
    chosen = max(0, reduced.ndim - INPUTS)
    splits = combinations(range(reduced.ndim), chosen)
    return min(_parts(reduced, axes) for axes in splits), int(chosen > 1)


def _needed(cube: Bits) -> Bits:
    """A function without the address bits that it does not depend on."""
    for axis in reversed(range(cube.ndim)):
        low, high = np.split(cube, 2, axis)
        if (low == high).all():
            cube = low.squeeze(axis)
    return cube


def _parts(cube: Bits, axes: tuple[int, ...]) -> int:
    """The different functions between which some address bits choose, that take a LUT each."""
    moved = np.moveaxis(cube, axes, range(len(axes))).reshape(1 << len(axes), -1)
    different = np.unique(moved, axis=0)
    inputs = cube.ndim - len(axes)
    return sum(_needed(one.reshape((2,) * inputs)).ndim > 1 for one in different)
