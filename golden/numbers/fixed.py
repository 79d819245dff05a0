"""Fixed-point formats, rounding and overflow: the only place where bits are defined.

A signal in the format ``Fix(width, frac)`` is a signed integer in two's complement, its *code*. The
code stands for the value ``code / 2**frac``. ``Fix(14, 13)`` is Q1.13: one sign bit and thirteen
fraction bits. Twins pass codes as ``int64`` arrays and never use floating point inside.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.input_error import InputError

Codes = NDArray[np.int64]


class Rounding(Enum):
    """What happens to the bits below the last one that is kept."""

    TRUNCATE = "truncate"  # floor, towards minus infinity
    ROUND = "round"  # to nearest, halves up


class Overflow(Enum):
    """What happens to a value outside the format."""

    WRAP = "wrap"  # the upper bits are dropped
    SATURATE = "saturate"  # the nearest end of the range


@dataclass(frozen=True)
class Fix:
    """A signed two's complement format.

    width: Number of bits including the sign, 2 to 62, so that codes and their sums fit in int64.
    frac: Number of fraction bits, 0 or more; it may exceed ``width``.
    """

    width: int
    frac: int

    def __post_init__(self) -> None:
        if not 2 <= self.width <= 62:
            raise InputError(f"Fix: width={self.width}, expected 2 to 62")
        if self.frac < 0:
            raise InputError(f"Fix: frac={self.frac}, expected 0 or more")

    def __str__(self) -> str:
        return f"Fix({self.width},{self.frac})"

    @property
    def low(self) -> int:
        return -(1 << (self.width - 1))

    @property
    def high(self) -> int:
        return (1 << (self.width - 1)) - 1

    def check(self, codes: ArrayLike, name: str = "codes", columns: int | None = None) -> Codes:
        """Return ``codes`` as int64 after checking type, shape and range.

        codes: Codes of this format.
        name: Name of the codes in an error message.
        columns: Required length of the last axis.
        """
        array = np.asarray(codes)
        if array.dtype.kind not in "iu":
            raise InputError(f"{name}: got dtype {array.dtype}, expected integer codes of {self}")
        if columns is not None and (array.ndim == 0 or array.shape[-1] != columns):
            raise InputError(f"{name}: got shape {array.shape}, expected (..., {columns})")
        if array.size and (array.min() < self.low or array.max() > self.high):
            outside = (array < self.low) | (array > self.high)
            at = np.unravel_index(int(np.argmax(outside)), array.shape)
            where = f" at index {tuple(int(i) for i in at)}" if array.ndim else ""
            raise InputError(
                f"{name}: got code {int(array[at])}{where}, "
                f"expected {self.low} to {self.high} of {self}"
            )
        return array.astype(np.int64, copy=False)

    def quantise(self, values: ArrayLike, name: str = "values") -> tuple[Codes, int]:
        """The codes nearest to real ``values`` (halves up), saturated to the format.

        Returns codes: the shape of ``values``.
        Returns saturated: How many values were outside the format and were replaced by its nearest
            end.
        """
        real = np.asarray(values, dtype=np.float64)
        bad = ~np.isfinite(real)
        if bad.any():
            at = np.unravel_index(int(np.argmax(bad)), real.shape)
            where = f" at index {tuple(int(i) for i in at)}" if real.ndim else ""
            raise InputError(f"{name}: got {real[at]}{where}, expected finite numbers")
        # It is a power of two, one addition and a floor, which IEEE 754 defines to the last bit.
        scaled = np.floor(np.ldexp(real, self.frac) + 0.5)
        saturated = int(((scaled < self.low) | (scaled > self.high)).sum())
        return np.clip(scaled, self.low, self.high).astype(np.int64), saturated

    def to_real(self, codes: ArrayLike) -> NDArray[np.float64]:
        """The real values for which ``codes`` stand."""
        # A product with a power of two is exact, and eight times as fast as ldexp.
        return np.asarray(codes, dtype=np.float64) * 2.0**-self.frac

    def texts(self, codes: Iterable[int]) -> list[str]:
        """The number for which each code stands, as text with six digits."""
        return real_texts(codes, self.frac)

    @classmethod
    def largest_frac(cls, width: int, values: Any, name: str = "values") -> Fix:
        """The format of ``width`` bits with the most fraction bits that still holds every value."""
        real = np.asarray(values, dtype=np.float64)
        for frac in range(width - 1, -1, -1):
            fmt = cls(width, frac)
            if fmt.quantise(real, name)[1] == 0:
                return fmt
        raise InputError(
            f"{name}: largest magnitude {float(np.abs(real).max()):g} does not fit {width} bits; "
            f"expected below {2 ** (width - 1)}"
        )


def real_texts(codes: Iterable[int], frac: int) -> list[str]:
    """The number for which each code with ``frac`` fraction bits stands, with six digits."""
    return [f"{int(code) / 2**frac:.6g}" for code in codes]


def check_unsigned(codes: ArrayLike, width: int, name: str) -> Codes:
    """Return ``codes`` as int64 after checking that they are unsigned numbers of ``width`` bits."""
    array = np.asarray(codes)
    if array.dtype.kind not in "iu":
        raise InputError(f"{name}: got dtype {array.dtype}, expected unsigned codes")
    if array.size and (array.min() < 0 or array.max() >= 1 << width):
        worst = int(array.min() if array.min() < 0 else array.max())
        raise InputError(f"{name}: got {worst}, expected 0 to {(1 << width) - 1}")
    return array.astype(np.int64)


def cut(codes: ArrayLike, shift: int, rounding: Rounding) -> Codes:
    """Drop ``shift`` fraction bits of exact codes; the result may have any width."""
    if shift < 0:
        raise InputError(f"cut: shift={shift}, expected 0 or more")
    exact = np.asarray(codes, dtype=np.int64)
    if not shift:
        return exact
    if rounding is Rounding.TRUNCATE:
        return np.asarray(exact >> shift, dtype=np.int64)
    # The sum is an array of its own, so the shift needs no third one.
    total = exact + (1 << (shift - 1))
    total >>= shift
    return np.asarray(total, dtype=np.int64)


def requantise(
    codes: ArrayLike, shift: int, target: Fix, rounding: Rounding, overflow: Overflow
) -> Codes:
    """Drop ``shift`` fraction bits and fit the result into ``target``.

    codes: Exact codes with ``target.frac + shift`` fraction bits.
    shift: Fraction bits to drop, 0 or more.
    target: Format of the result.
    rounding, overflow: Both policies must always be stated.
    """
    kept = cut(codes, shift, rounding)
    if overflow is Overflow.SATURATE:
        return np.asarray(np.clip(kept, target.low, target.high), dtype=np.int64)
    span = 1 << target.width
    return np.asarray(((kept - target.low) % span) + target.low, dtype=np.int64)


def signed_width(bounds: Iterable[int]) -> int:
    """Number of bits of the smallest signed number that holds all of ``bounds``."""
    return max(2, *((b.bit_length() if b >= 0 else (-b - 1).bit_length()) + 1 for b in bounds))
