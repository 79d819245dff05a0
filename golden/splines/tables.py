"""A network of learned functions in integers: every curved edge is a table of straight lines."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from golden.domain import checked
from golden.fixed import Codes, Fix
from golden.input_error import InputError
from golden.precision import SIGNAL
from golden.real import Real
from golden.splines.basis import Basis
from golden.splines.edges import CURVED, STRAIGHT
from golden.splines.training import Learned

WORD = 18
# Points of each segment to which its line is fitted.
POINTS = 17
# Hidden sums of the training rows fill this part of their format at most.
FILLED = 0.8


@dataclass(frozen=True)
class Line:
    """The lines of an edge, one for each segment; a straight edge has a single segment.

    Equation: ``intercept + slope * (code - middle)``, in units of ``2**-frac`` of the sum.

    Attributes
    ----------
    fmt : Fix
        The format of the code.
    intercepts, slopes : int64 arrays, shape (segments,)
    frac, slope_frac : int
        Fraction bits of the intercepts, and of the slopes times the weight of a code.
    """

    fmt: Fix
    intercepts: Codes
    slopes: Codes
    frac: int
    slope_frac: int

    def at(self, codes: Codes) -> tuple[Codes, int]:
        """The values at codes, and their fraction bits."""
        width = (1 << self.fmt.width) // len(self.slopes)
        segment = (codes - self.fmt.low) // width
        # The distance is from the middle of the segment.
        distance = codes - self.fmt.low - segment * width - width // 2
        most = max(self.frac, self.slope_frac)
        value = (self.intercepts[segment] << (most - self.frac)) + (
            (self.slopes[segment] * distance) << (most - self.slope_frac)
        )
        return value, most


@dataclass(frozen=True)
class TableNetwork:
    """The sums of lines, each of which is rounded once.

    Attributes
    ----------
    first : tuple of tuples of Line, shape (hidden, inputs)
    second : tuple of tuples of Line, shape (outputs, hidden)
    sums : tuple of Fix
        The format of each hidden sum.
    words : int
        The words of 36 bits: those of the tables, each an intercept and a slope.
    """

    first: tuple[tuple[Line, ...], ...]
    second: tuple[tuple[Line, ...], ...]
    sums: tuple[Fix, ...]
    words: int

    def process(self, codes: Codes) -> Codes:
        """Output codes, shape (frames, outputs), of input codes, shape (frames, inputs)."""
        hidden = [
            _summed(node, codes, fmt) for node, fmt in zip(self.first, self.sums, strict=True)
        ]
        taken = np.stack(hidden, axis=1)
        return np.stack([_summed(node, taken, SIGNAL) for node in self.second], axis=1)


def tabulated(learned: Learned, inputs: Real, segments: int) -> TableNetwork:
    """A network in integers, with so many segments for each curved edge.

    Parameters
    ----------
    learned : Learned
    inputs : float array, shape (rows, inputs)
        Rows that say how large hidden sums become.
    segments : int
        A power of two, 2 to 4096.

    Raises
    ------
    InputError
        For another number of segments.
    """
    checked(segments=(segments, 2, 4096))
    if segments & (segments - 1):
        raise InputError(f"segments: got {segments}, expected a power of two")
    network, edges = learned.network, learned.edges
    largest = np.abs(network.sums(network.spread(inputs))).max(axis=0)
    whole = np.ceil(np.log2(np.maximum(largest, 2.0**-WORD) / FILLED)).astype(np.int64)
    sums = tuple(Fix(WORD, WORD - 1 - int(bits)) for bits in whole)
    first = tuple(
        tuple(
            _line(basis, edge, int(kind), SIGNAL, segments)
            for basis, edge, kind in zip(network.bases, node, kinds, strict=True)
        )
        for node, kinds in zip(network.first, edges.first, strict=True)
    )
    second = tuple(
        tuple(
            _line(network.hidden, edge, int(kind), fmt, segments, network.biases[o] * (h == 0))
            for h, (edge, kind, fmt) in enumerate(zip(node, kinds, sums, strict=True))
        )
        for o, (node, kinds) in enumerate(zip(network.second, edges.second, strict=True))
    )
    words = segments * int((edges.kinds == CURVED).sum())
    return TableNetwork(first, second, sums, words)


def _line(basis: Basis, edge: Real, kind: int, fmt: Fix, segments: int, bias: float = 0.0) -> Line:
    """The lines of an edge, each of them as far above the function as below it."""
    count = segments if kind == CURVED else 1
    width = (1 << fmt.width) // count
    starts = fmt.low + width * np.arange(count)
    places = starts[:, np.newaxis] + np.linspace(0, width, POINTS)
    values = basis.at(places * 2.0**-fmt.frac)[0] @ edge + bias
    slopes = (values[:, -1] - values[:, 0]) / width * (kind >= STRAIGHT)
    off = values - slopes[:, np.newaxis] * (places - starts[:, np.newaxis] - width // 2)
    intercepts = (off.max(axis=1) + off.min(axis=1)) / 2
    kept = [Fix.largest_frac(WORD, part, "table") for part in (intercepts, slopes * 2.0**fmt.frac)]
    words = [
        held.quantise(part, "table")[0]
        for held, part in zip(kept, (intercepts, slopes * 2.0**fmt.frac), strict=True)
    ]
    return Line(fmt, words[0], words[1], kept[0].frac, kept[1].frac + fmt.frac)


def _summed(node: tuple[Line, ...], codes: Codes, fmt: Fix) -> Codes:
    """The sum of a node's lines, rounded to a format once."""
    parts = [line.at(codes[:, i]) for i, line in enumerate(node)]
    most = max(frac for _, frac in parts)
    total = sum(
        ((value << (most - frac)) for value, frac in parts), start=np.zeros(len(codes), np.int64)
    )
    drop = most - fmt.frac
    rounded: Codes = (total + (1 << (drop - 1))) >> drop
    return np.asarray(np.clip(rounded, fmt.low, fmt.high))
