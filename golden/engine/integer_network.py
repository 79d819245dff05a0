"""A network in whole numbers, from which engines are compiled, and its evaluation.

A network in floating point is quantised into it, and a quantised one is read into it
(``golden.engine.quantise``). Its evaluation is plain arithmetic in Python's integers, without a
program, terms or accumulators. So it judges everything that is compiled from it.

The words that pass from layer to layer have 18 bits. A layer adds up products of weights and words,
rounds each sum to a code, clips the code, and shifts it left to the place of a word.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from operator import mul

import numpy as np

from golden.engine.formats import DROPPED, OUTPUT_SHIFT, RESULT, SAMPLE_SHIFT
from golden.engine.function_table import table_of
from golden.engine.ranges import Range
from golden.numbers.fixed import Codes, Fix
from golden.trained.function import Function


class LayerRounding(Enum):
    """What the dropped bits of a sum do to its code."""

    UP = "to the nearest code, halves up"
    EVEN = "to the nearest code, halves to the even one"
    DOWN = "to the code below"


@dataclass(frozen=True)
class IntegerLayer:
    """One layer in whole numbers.

    weights: For each node a weight for each word that the layer takes.
    starts: What the sum of each node begins with, in units of a product.
    result: Format of the words that its codes become.
    shift: How many of the lowest bits of a sum are dropped.
    low, high: The ends to which codes are clipped; a ReLU has 0 as its low end.
    cut: How far a code is shifted left in its word. Only a layer with a quantiser shifts.
    leaky: Whether each node gives two words: its own, and 0 instead of a negative one.
    functions: The function of each node, whose value is the word that the node gives; empty for
        none.
    added: For each node the functions of words that are added to its sum; empty for none. Their
        values have the format of ``result``.
    range: The range of a layer in which saturation would be an error.
    """

    weights: tuple[tuple[int, ...], ...]
    starts: tuple[int, ...]
    result: Fix
    shift: int = DROPPED
    rounding: LayerRounding = LayerRounding.UP
    low: int = RESULT.low
    high: int = RESULT.high
    cut: int = 0
    leaky: bool = False
    functions: tuple[Function, ...] = ()
    added: tuple[tuple[tuple[int, Function], ...], ...] = ()
    range: Range | None = None

    @property
    def nodes(self) -> int:
        return len(self.starts)

    @property
    def rectifies(self) -> bool:
        """Whether a sum below 0 becomes 0."""
        return self.low == 0

    def added_to(self, node: int) -> tuple[tuple[int, Function], ...]:
        """The functions of words that are added to the sum of a node."""
        return self.added[node] if self.added else ()

    @property
    def every_function(self) -> tuple[Function, ...]:
        """The functions that its nodes look up, and those that are added to its sums."""
        added = (function for node in self.added for _, function in node)
        return tuple(dict.fromkeys((*self.functions, *added)))

    def sums(self, words: Sequence[int], segment_width: int) -> list[int]:
        """The sum of each node."""
        return [
            start
            + sum(map(mul, row, words))
            + sum(line_at(function, segment_width, words[k]) for k, function in self.added_to(j))
            for j, (start, row) in enumerate(zip(self.starts, self.weights, strict=True))
        ]

    def rounded(self, total: int) -> int:
        """The code of a sum, before it is clipped."""
        code, rest = divmod(total, 1 << self.shift)
        twice, whole = 2 * rest, 1 << self.shift
        if self.rounding is LayerRounding.DOWN:
            return code
        halfway_up = self.rounding is LayerRounding.UP or code % 2 == 1
        return code + (twice > whole or (twice == whole and halfway_up))

    def code(self, total: int) -> int:
        """The code of a sum."""
        return max(self.low, min(self.high, self.rounded(total)))

    def words_for_next_layer(self, codes: Sequence[int], segment_width: int) -> list[int]:
        """The words that the next layer takes."""
        words = [code << self.cut for code in codes]
        if self.leaky:
            return [word for pair in ((w, max(0, w)) for w in words) for word in pair]
        if self.functions:
            pairs = zip(self.functions, words, strict=True)
            return [looked_up(function, segment_width, word) for function, word in pairs]
        return words


@dataclass(frozen=True)
class IntegerNetwork:
    """A network in whole numbers.

    samples, earlier: How many samples it takes, and how many outputs of earlier networks behind
        them.
    layers: The starts of the last one hold half a unit of an output, and its rounding is down. So
        an output is the word without its lowest bits. Later networks take the whole word.
    segment_width: Bits of a sum within a segment of the table of a function.
    """

    samples: int
    earlier: int
    layers: tuple[IntegerLayer, ...]
    segment_width: int

    def run(self, words: Sequence[int]) -> Iterator[tuple[list[int], list[int]]]:
        """The sums and the codes of each layer, for the words of one frame."""
        for layer in self.layers:
            sums = layer.sums(words, self.segment_width)
            codes = [layer.code(total) for total in sums]
            yield sums, codes
            words = layer.words_for_next_layer(codes, self.segment_width)

    def hidden_codes(self, frames: Codes) -> list[Codes]:
        """The codes of each hidden layer, shape (frames, nodes), for frames of samples alone."""
        found = [[codes for _, codes in self.run(words)] for words in sample_words(frames)]
        return [np.array(codes) for codes in list(zip(*found, strict=True))[:-1]]


def sample_words(frames: Codes) -> list[list[int]]:
    """The words of the samples of each frame."""
    found: list[list[int]] = (np.asarray(frames, dtype=np.int64) << SAMPLE_SHIFT).tolist()
    return found


def evaluate(networks: Sequence[IntegerNetwork], frames: Codes) -> Codes:
    """Output codes of networks on the same samples, shape (frames, outputs).

    networks: Each may take outputs of those before it.
    frames: shape (frames, samples).
    """
    found = []
    for words in sample_words(frames):
        outputs: list[int] = []
        for network in networks:
            *_, (_, codes) = network.run([*words, *outputs[: network.earlier]])
            outputs += codes
        found.append([word >> OUTPUT_SHIFT for word in outputs])
    return np.array(found)


def looked_up(function: Function, segment_width: int, q: int) -> int:
    """The word of a function of the word q, from its table."""
    total = line_at(function, segment_width, q)
    return max(RESULT.low, min(RESULT.high, (total + (1 << (DROPPED - 1))) >> DROPPED))


def line_at(function: Function, segment_width: int, q: int) -> int:
    """The line of a function's table at the word q, in units of a product."""
    table = table_of(function, segment_width)
    span, segments = 1 << segment_width, len(table.slopes) // (1 + table.both)
    segment = min((q if q >= 0 else -q - 1) // span, segments - 1)
    if table.both and q < 0:
        segment += segments
    one = 1 << DROPPED if q >= 0 else -(1 << DROPPED)
    return table.intercepts[segment] * one + table.slopes[segment] * (q % span - span // 2)
