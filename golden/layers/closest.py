"""Samples whose weighted sum is a given number, or the closest to it on one side."""

from __future__ import annotations

import numpy as np

from golden.fixed import Codes, Fix

# Choices of all samples but two. A choice leaves 2**28 pairs of two samples, far more than one sum
# in a hundred is missed by.
CHOICES = 400


def closest(
    fmt: Fix,
    weights: Codes,
    start: int,
    shift: int,
    target: int,
    above: bool,
    rng: np.random.Generator,
) -> Codes | None:
    """Samples with ``start + sum((w x) >> shift)`` as close to ``target`` as is found.

    With two weights or fewer that are not 0, none is closer; with more, a search over two samples
    at a time, all of whose pairs are tried, ends at the first sum than which none is closer.

    Parameters
    ----------
    fmt : Fix
        Format of the samples.
    weights : int64 array
    start : int
        What the products are added to.
    shift : int
        Bits cut from each product.
    target : int
    above : bool
        Whether the sum must be ``target`` or more; otherwise it must be that or less.
    rng : Generator
        Chooses the samples.

    Returns
    -------
    int64 array, or None
        None where no sum on that side is found.
    """
    row = np.asarray(weights, dtype=np.int64)
    places = np.flatnonzero(row)
    codes = np.arange(fmt.low, fmt.high + 1)
    # Whole products differ by multiples of this, so that no sum is closer than ``least``.
    step = 1 if shift else max(1, int(np.gcd.reduce(row)))
    least = (start - target if above else target - start) % step
    best, found = None, None
    for _ in range(CHOICES if len(places) > 2 else 1):
        frame = _others(fmt, row, start, shift, target, rng)
        pair = rng.choice(places, min(2, len(places)), replace=False)
        frame[pair] = 0
        need = target - start - int(((row * frame) >> shift).sum())
        first, second = (
            ((row[pair[n]] * codes) >> shift if len(pair) > n else np.zeros(1, dtype=np.int64))
            for n in (1, 0)
        )
        gap, at_first, at_second = _closest_pair(first, second, need, above, rng)
        if gap is None or (best is not None and gap >= best):
            continue
        best, found = gap, frame
        for n, at in ((1, at_first), (0, at_second)):
            if len(pair) > n:
                found[pair[n]] = codes[at]
        if best == least:
            break
    return found


def _closest_pair(
    first: Codes, second: Codes, need: int, above: bool, rng: np.random.Generator
) -> tuple[int | None, int, int]:
    """By how much the closest sum of two terms misses, and the places of the terms.

    Terms rise or fall from place to place.
    """
    falls = second[0] > second[-1]
    rising = second[::-1] if falls else second
    rest = need - first
    if above:
        at = np.searchsorted(rising, rest, side="left")
    else:
        at = np.searchsorted(rising, rest, side="right") - 1
    valid = np.flatnonzero((at >= 0) & (at < len(rising)))
    if not len(valid):
        return None, 0, 0
    gaps = np.abs(rising[at[valid]] - rest[valid])
    chosen = valid[rng.choice(np.flatnonzero(gaps == gaps.min()))]
    place = int(at[chosen])
    return int(gaps.min()), int(chosen), len(second) - 1 - place if falls else place


def _others(
    fmt: Fix, row: Codes, start: int, shift: int, target: int, rng: np.random.Generator
) -> Codes:
    """Samples about as far towards their ends as the target asks for."""
    span = max(1.0, float(np.abs(row).sum()) * -fmt.low / 2**shift)
    part = float(np.clip((target - start) / span, -1, 1))
    noise = rng.uniform(-1, 1, len(row)) * (1 - abs(part))
    real = (part * np.sign(row) + noise) * -fmt.low
    return np.clip(np.round(real), fmt.low, fmt.high).astype(np.int64)
