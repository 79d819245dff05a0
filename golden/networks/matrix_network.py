"""Compiles an integer network to constant matrices, whose finish is the activation of a layer.

A ReLU, a clip and a rounding are the finish of a matrix. tanh, and so sigmoid, becomes tables
behind it. A leaky ReLU is two rows of the same sum, one of them rectified.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from operator import or_
from typing import Any

from golden.activation.bipartite import GROUP_WIDTH, NODES, Bipartite, bipartite_for
from golden.activation.bipartite import RESULT as TANH_RESULT
from golden.engine.formats import OUTPUT_SHIFT, RESULT, SAMPLE_SHIFT
from golden.engine.integer_network import IntegerLayer, IntegerNetwork, LayerRounding
from golden.engine.ranges import Range
from golden.input_error import InputError, naming
from golden.layers.constant_matrix import ConstantMatrix, Finish
from golden.layers.shift_add import Ends, sum_ends
from golden.numbers.fixed import Fix, signed_width
from golden.numbers.precision import EXACT, SIGNAL
from golden.trained.function import TANH

# Bits of a word from layer to layer, where neither a quantiser nor the scene says how many there
# are: as many as tanh has. An engine keeps more, which cost it nothing.
WORD_WIDTH = TANH_RESULT.width
# Bits below the last place of a word that take part in the additions.
GUARD = 1
# Fraction bits of a word of tanh beyond those of a table's code, which means the middle of a step.
_TANH_SHIFT = RESULT.frac - TANH_RESULT.frac


@dataclass(frozen=True)
class LayerWord:
    """A word of the integer network that a matrix takes: ``scale * code + offset``.

    ends: The least and the largest code.
    """

    ends: tuple[int, int]
    scale: int
    offset: int = 0


@dataclass(frozen=True)
class LayerWords:
    """The words from one layer to the next, by their number in the integer network.

    fmt: Format of the codes that stand for them.
    live: Those that the matrix takes, in the order of its samples.
    fixed: The values of those that never change.
    """

    fmt: Fix
    live: dict[int, LayerWord]
    fixed: dict[int, int]

    @property
    def ends(self) -> Ends:
        """The least and the largest code of each word that the matrix takes."""
        return tuple(word.ends for word in self.live.values())


def compile_matrices(
    network: IntegerNetwork, word_width: int, adders: Mapping[str, Any]
) -> dict[str, Any]:
    """The matrices and tables of an integer network, by the names that ``AdderGraph`` has for them.

    network: It takes samples alone.
    word_width: Bits of a word from layer to layer where no quantiser says how many there are, and
        no table; 0 for ``WORD_WIDTH``.
    adders: What a scene chooses of each ``ConstantMatrix``.

    If a layer has a quantiser, no bit of any sum is cut, and words keep all their bits. Then every
    word is that of the integer network, unless it comes from a table, and so is every output: ties
    are as exact as there. Other networks keep ``word_width`` bits of a word, and ``GUARD`` bits
    below the last place of a result.

    Hidden nodes that no output uses are not built, and neither are nodes that never change.
    """
    exact = any(layer.cut for layer in network.layers)
    if word_width and (exact or all(layer.functions for layer in network.layers[:-1])):
        raise InputError(
            f"hardware.word_width: got {word_width}, expected none: every hidden layer has "
            "a quantiser or a table, which has a width of its own"
        )
    sample = LayerWord((SIGNAL.low, SIGNAL.high), 1 << SAMPLE_SHIFT)
    words = LayerWords(SIGNAL, dict.fromkeys(range(network.samples), sample), {})
    matrices: list[ConstantMatrix] = []
    activations: list[tuple[Bipartite, ...]] = []
    ranges: list[Range] = []
    useless = constant = 0
    used = _used(network.layers)
    for number, (layer, columns) in enumerate(zip(network.layers, used, strict=True), start=1):
        output = number == len(network.layers)
        with naming(layer_name(number)):
            step = _Step(layer, output, exact, words, word_width or WORD_WIDTH, adders)
            fixed = {} if output else step.fixed(columns)
            # A matrix has one row at least.
            live = [column for column in columns if column not in fixed] or columns[:1]
            place = number if len(network.layers) > 2 else ""
            name = "outputs" if output else f"hidden{place}"
            matrix = step.matrix(live, name)
        if layer.range:
            unit = 1 << max(0, step.dropped - layer.result.frac)
            found = replace(layer.range, fmt=matrix.out_fmt, layer=layer_name(number), unit=unit)
            ranges.append(found)
        matrices.append(matrix)
        if not output:
            useless += layer.nodes - len(step.nodes(columns))
            constant += len(step.nodes(columns)) - len(step.nodes(live))
            tables = [step.table] * len(matrix.weights) if layer.functions else []
            activations.append(tabled(tables, matrix.result_widths))
            given = dict(zip(live, step.given(matrix, activations[-1]), strict=True))
            left = {column: value for column, value in fixed.items() if column not in given}
            fmt = TANH_RESULT if activations[-1] else matrix.out_fmt
            words = LayerWords(fmt, given, left)
    return {
        "layers": tuple(matrices),
        "activations": tuple(activations),
        "useless_nodes": useless,
        "constant_nodes": constant,
        "ranges": tuple(ranges),
    }


def layer_name(number: int) -> str:
    """What a layer is called in messages; the first one has number 1."""
    return f"layer {number}"


def tabled(activations: Sequence[Bipartite], widths: Sequence[int]) -> tuple[Bipartite, ...]:
    """The activations of nodes whose q have these bits; those that share tables have one width."""
    found = list(activations)
    for nodes in groups_of(activations, widths):
        least = GROUP_WIDTH + 2
        width = max(least, *(widths[j] for j in nodes))
        for j in nodes:
            found[j] = activations[j].taking(width)
    return tuple(found)


def groups_of(
    activations: Sequence[Bipartite], widths: Sequence[int]
) -> tuple[tuple[int, ...], ...]:
    """The nodes that share their tables: two nodes of similar width."""
    if not activations:
        return ()
    order = sorted(range(len(widths)), key=lambda j: (widths[j], j))
    return tuple(tuple(order[n : n + NODES]) for n in range(0, len(order), NODES))


def _used(layers: Sequence[IntegerLayer]) -> list[list[int]]:
    """The words of each layer that a later layer uses; of the last one, all outputs."""
    found = [list(range(layer.nodes * (1 + layer.leaky))) for layer in layers]
    for n in range(len(layers) - 1, 0, -1):
        per = 1 + layers[n].leaky
        rows = [layers[n].weights[j] for j in sorted({column // per for column in found[n]})]
        kept = sorted({k for row in rows for k, code in enumerate(row) if code})
        found[n - 1] = kept or [0]
    return found


@dataclass(frozen=True)
class _Step:
    """One layer on its way into a matrix. ``words`` are those that it takes."""

    layer: IntegerLayer
    output: bool
    exact: bool
    words: LayerWords
    word_width: int
    adders: Mapping[str, Any]

    def __post_init__(self) -> None:
        names = sorted({one.name for one in self.layer.every_function if one != TANH})
        if names:
            raise InputError(
                f"hardware.design: got 'adder_graph' with the functions {', '.join(names)}, "
                "expected 'engine', which has tables of any, or tanh, sigmoid, relu, leaky_relu, "
                "hard_tanh and linear alone"
            )

    @property
    def table(self) -> Bipartite:
        """The table of tanh for any q."""
        return bipartite_for(EXACT, 1, EXACT.hidden_fmt.high)

    @property
    def dropped(self) -> int:
        """How many bits of a word of the integer network its code lacks."""
        plain = not (self.exact or self.output or self.layer.functions)
        return RESULT.width - self.word_width if plain else 0

    @property
    def shift(self) -> int:
        """How many bits of a sum its code lacks."""
        return self.layer.shift + self.dropped + OUTPUT_SHIFT * self.output

    @property
    def half(self) -> int:
        """What is added to a sum to round it. A code of q stands for the middle of its step."""
        down = self.layer.rounding is LayerRounding.DOWN or self.layer.functions
        return 0 if down else 1 << (self.shift - 1)

    def nodes(self, columns: Sequence[int]) -> set[int]:
        """The nodes to which some words of the next layer belong."""
        return {column // (1 + self.layer.leaky) for column in columns}

    def rectified(self, column: int) -> bool:
        """Whether a word is 0 instead of negative."""
        return self.layer.rectifies or (self.layer.leaky and column % 2 == 1)

    def row(self, column: int) -> tuple[list[int], int]:
        """The weights of the codes in the sum behind a word, and its constant."""
        node, words = column // (1 + self.layer.leaky), self.words
        row, start = self.layer.weights[node], self.layer.starts[node]
        start += sum(row[k] * value for k, value in words.fixed.items())
        start += sum(row[k] * word.offset for k, word in words.live.items())
        return [row[k] * word.scale for k, word in words.live.items()], start

    def fixed(self, columns: Sequence[int]) -> dict[int, int]:
        """The values of those words that are the same for all samples."""
        found = {}
        for column in columns:
            ends = sum_ends(*self.row(column), self.words.ends)
            low, high = (self.value(column, total) for total in ends)
            # No activation falls, so what lies between is the same, too.
            if low == high:
                found[column] = low
        return found

    def value(self, column: int, total: int) -> int:
        """The word that a sum becomes."""
        layer = self.layer
        if layer.functions:
            q = EXACT.hidden_fmt
            q_code = max(q.low, min(q.high, total >> self.shift))
            code = int(self.table.process([q_code])[0])
            return _of_tanh(code, code).offset + (code << _TANH_SHIFT)
        code = int(layer.codes(total))
        return (max(0, code) if self.rectified(column) else code) << layer.cut

    def matrix(self, columns: Sequence[int], variant: str) -> ConstantMatrix:
        """The matrix that gives the codes of some words."""
        pairs = [self.row(column) for column in columns]
        even = self.layer.rounding is LayerRounding.EVEN
        # Zeros at the end of all weights are no part of the graph.
        bits = reduce(or_, (abs(weight) for row, _ in pairs for weight in row))
        zeros = min((bits & -bits).bit_length() - 1 if bits else self.shift, self.shift - even)
        starts = [start + self.half for _, start in pairs]
        finishes = tuple(
            # A constant with bits below those of all products leaves no tie.
            Finish(self.rectified(column), even and not start % (1 << zeros))
            for column, start in zip(columns, starts, strict=True)
        )
        shift, ends = self.shift - zeros, self.words.ends
        whole = set(ends) == {(self.words.fmt.low, self.words.fmt.high)}
        sums = [sum_ends(*pair, ends) for pair in pairs]
        return ConstantMatrix(
            self.words.fmt,
            self.out_fmt([end >> self.shift for pair in sums for end in pair]),
            tuple(tuple(weight >> zeros for weight in row) for row, _ in pairs),
            tuple(start >> zeros for start in starts),
            shift,
            shift if self.exact else GUARD,
            finishes=finishes if any(finish != Finish() for finish in finishes) else (),
            in_ends=() if whole else ends,
            variant=variant,
            **self.adders,
        )

    def out_fmt(self, results: Sequence[int]) -> Fix:
        """The format of the codes, whose sums without their last bits end at ``results``."""
        layer = self.layer
        if self.output:
            return SIGNAL
        if layer.functions:
            # A table takes any q, however its last bits are cut.
            return Fix(signed_width((min(results) - 1, max(results) + 1)), layer.result.frac)
        width = (layer.high >> self.dropped).bit_length() + 1
        # The codes of a quantiser are whole numbers.
        return Fix(width, 0 if layer.cut else max(0, layer.result.frac - self.dropped))

    def given(self, matrix: ConstantMatrix, tables: Sequence[Bipartite]) -> list[LayerWord]:
        """The words that the next layer takes."""
        if not tables:
            return [
                LayerWord(ends, 1 << (self.layer.cut + self.dropped)) for ends in matrix.result_ends
            ]
        pairs = zip(tables, matrix.result_ends, strict=True)
        return [_of_tanh(*table.process(ends).tolist()) for table, ends in pairs]


def _of_tanh(low: int, high: int) -> LayerWord:
    """The word of a table whose codes are ``low`` to ``high``."""
    return LayerWord((low, high), 1 << _TANH_SHIFT, 1 << _TANH_SHIFT >> 1)
