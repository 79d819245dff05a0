"""Samples whose weighted sum is a given number, or the closest to it on one side."""

import numpy as np

from golden.layers.shift_add import Ends
from golden.numbers.fixed import Codes

# How often all samples but two are chosen at random. Each choice leaves 2**28 pairs for the other
# two samples, so that few sums are missed.
CHOICES = 400


def closest(
    ends: Ends,
    weights: Codes,
    start: int,
    shift: int,
    target: int,
    above: bool,
    rng: np.random.Generator,
) -> Codes | None:
    """Search samples whose sum ``start + sum((w x) >> shift)`` is as close to ``target`` as can be.

    With at most two weights that are not 0, no other samples are closer. With more, the search
    varies two samples at a time and tries all of their pairs; it ends early at a sum that cannot be
    improved.

    ends: For each sample its least and its largest value.
    start: Number to which the products are added.
    shift: Number of low bits that are dropped from each product.
    above: Whether the sum must be ``target`` or more; otherwise it must be ``target`` or less.
    rng: Source of the random choices.

    Returns: None where the search finds no sum on that side.
    """
    row = np.asarray(weights, dtype=np.int64)
    places = np.flatnonzero(row)
    # Products without dropped bits differ by multiples of this step, so no sum is closer than
    # ``least``.
    step = 1 if shift else max(1, int(np.gcd.reduce(row)))
    least = (start - target if above else target - start) % step
    best, found = None, None
    for _ in range(CHOICES if len(places) > 2 else 1):
        frame = _others(ends, row, start, shift, target, rng)
        pair = rng.choice(places, min(2, len(places)), replace=False)
        frame[pair] = 0
        need = target - start - int(((row * frame) >> shift).sum())
        codes = [np.arange(ends[k][0], ends[k][1] + 1) for k in pair]
        first, second = (
            ((row[pair[n]] * codes[n]) >> shift if len(pair) > n else np.zeros(1, dtype=np.int64))
            for n in (1, 0)
        )
        gap, at_first, at_second = _closest_pair(first, second, need, above, rng)
        if gap is None or (best is not None and gap >= best):
            continue
        best, found = gap, frame
        for n, at in ((1, at_first), (0, at_second)):
            if len(pair) > n:
                found[pair[n]] = codes[n][at]
        if best == least:
            break
    return found


def _closest_pair(
    first: Codes, second: Codes, need: int, above: bool, rng: np.random.Generator
) -> tuple[int | None, int, int]:
    """The distance of the closest sum of two terms from ``need``, and the indices of both terms.

    Each list of terms must rise or fall throughout.
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
    ends: Ends, row: Codes, start: int, shift: int, target: int, rng: np.random.Generator
) -> Codes:
    """Random samples that are about as far from the middle of their ends as the target requires."""
    low, high = np.array(ends, dtype=np.float64).T
    middle, half = (low + high + 1) / 2, (high - low + 1) / 2
    span = max(1.0, float((np.abs(row) * half).sum()) / 2**shift)
    part = float(np.clip((target - start - (row * middle).sum() / 2**shift) / span, -1, 1))
    noise = rng.uniform(-1, 1, len(row)) * (1 - abs(part))
    real = middle + (part * np.sign(row) + noise) * half
    found: Codes = np.clip(np.round(real), low, high).astype(np.int64)
    return found
