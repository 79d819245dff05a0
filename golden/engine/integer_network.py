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
from typing import Any

import numpy as np
from numpy.typing import NDArray

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

    def sums(self, words: Codes, segment_width: int) -> NDArray[Any]:
        """The sum of each node, shape (frames, nodes), in Python's integers."""
        found = words.astype(object) @ np.array(self.weights, dtype=object).T
        found += np.array(self.starts, dtype=object)
        for node, added in enumerate(self.added):
            for word, function in added:
                found[:, node] += table_of(function, segment_width).sums(words[:, word])
        return found

    def rounded(self, totals: Any) -> Any:
        """The code of each sum, before it is clipped."""
        half = 1 << (self.shift - 1)
        added = {
            LayerRounding.DOWN: 0,
            LayerRounding.UP: half,
            # Half way between two codes, only an odd one is passed.
            LayerRounding.EVEN: half - 1 + (totals >> self.shift & 1),
        }
        return (totals + added[self.rounding]) >> self.shift

    def codes(self, totals: Any) -> Codes:
        """The code of each sum."""
        return np.asarray(np.clip(self.rounded(totals), self.low, self.high), dtype=np.int64)

    def words_for_next_layer(self, codes: Codes, segment_width: int) -> Codes:
        """The words that the next layer takes."""
        words = codes << self.cut
        if self.leaky:
            words = np.stack([words, np.maximum(0, words)], axis=-1).reshape(len(words), -1)
        for node, function in enumerate(self.functions):
            words[:, node] = table_of(function, segment_width).results(words[:, node])
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

    def run(self, words: Codes) -> Iterator[tuple[NDArray[Any], Codes]]:
        """The sums and the codes of each layer, shape (frames, nodes), for the words of frames."""
        for layer in self.layers:
            sums = layer.sums(words, self.segment_width)
            codes = layer.codes(sums)
            yield sums, codes
            words = layer.words_for_next_layer(codes, self.segment_width)

    def hidden_codes(self, frames: Codes) -> list[Codes]:
        """The codes of each hidden layer, shape (frames, nodes), for frames of samples alone."""
        return [codes for _, codes in self.run(sample_words(frames))][:-1]


def sample_words(frames: Codes) -> Codes:
    """The words of the samples of frames."""
    return np.asarray(frames, dtype=np.int64) << SAMPLE_SHIFT


def evaluate(networks: Sequence[IntegerNetwork], frames: Codes) -> Codes:
    """Output codes of networks on the same samples, shape (frames, outputs).

    networks: Each may take outputs of those before it.
    frames: shape (frames, samples).
    """
    words = sample_words(frames)
    for network in networks:
        *_, (_, codes) = network.run(words[:, : network.samples + network.earlier])
        words = np.hstack([words, codes])
    return words[:, frames.shape[1] :] >> OUTPUT_SHIFT
