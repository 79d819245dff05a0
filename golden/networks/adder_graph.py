"""Adder graph: a network of any depth without a multiplier, which takes a frame every clock."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np

from golden.activation.bipartite import NODES, RESULT, Bipartite, BipartitePair
from golden.common.flow import Flow, Replicated, Step, Wire
from golden.engine.quantise import integer_networks
from golden.engine.ranges import Range
from golden.input_error import InputError
from golden.layers.constant_matrix import ConstantMatrix
from golden.networks.constants import Constants, Layer, constants_of
from golden.networks.design import AtOnce, Settings
from golden.networks.matrix_network import (
    GUARD,
    compile_matrices,
    groups_of,
    layer_name,
    tabled,
)
from golden.networks.network import CHUNK
from golden.numbers.fixed import Codes, Fix, signed_width
from golden.numbers.precision import EXACT, SIGNAL
from golden.trained.dense import DenseNetwork

# The options of a scene that does not set them: the most adders between two registers, the most
# operands of an adder, the bits of a word, which are then those of ``whole_layers``, and the runs
# of the search for shared terms, which ``shared`` then limits.
OPTIONS = {"adders_per_clock": 5, "adder_operands": 2, "word_width": 0, "search_runs": 0}


@dataclass(frozen=True)
class AdderGraph(AtOnce):
    """Layer after layer; shifted adds form all sums of a layer together, without a multiplier.

    layers: A matrix for each layer, with a row for each node; the rows of the last one are the
        outputs.
    activations: For each hidden layer a table of tanh for each row, or none if the finish of the
        matrix is its activation. The result of a matrix in front of tables has as many bits of q as
        its sum can need.
    constant_nodes: Hidden nodes that are not built, because they never change: they are part of
        biases.
    ranges: Of the hidden layers in which saturation would be an error.

    A code of q or r stands for the middle of its step. So q is rounded down, and half the sum of
    the weights of a row behind tables is part of its bias. An output is rounded half up.

    A network of one hidden layer of tanh has the weights of every other design
    (``golden.networks.constants``). Any other is compiled from its integer network
    (``golden.networks.matrix_network``).
    """

    block = "adder_graph"
    known_activations = ("bipartite",)
    options = tuple(OPTIONS)
    layers: tuple[ConstantMatrix, ...]
    activations: tuple[tuple[Bipartite, ...], ...]
    constant_nodes: int = field(default=0, kw_only=True)
    ranges: tuple[Range, ...] = field(default=(), kw_only=True)

    @classmethod
    def build(
        cls, networks: Sequence[DenseNetwork], settings: Settings, arrangement: str, variant: str
    ) -> Self:
        adders: dict[str, Any] = {**OPTIONS, **settings.options}
        word_width = adders.pop("word_width")
        if len(networks) > 1 or networks[0].plain:
            if word_width:
                raise InputError(
                    f"hardware.word_width: got {word_width}, expected none: a hidden layer of tanh "
                    "has words as wide as its table"
                )
            return cls._of_tanh(networks, settings, adders, variant)
        (network,) = integer_networks("single", networks, settings.met)
        return cls(**compile_matrices(network, word_width, adders), variant=variant)

    @classmethod
    def _of_tanh(
        cls,
        networks: Sequence[DenseNetwork],
        settings: Settings,
        adders: Mapping[str, Any],
        variant: str,
    ) -> Self:
        """The design of networks of one hidden layer of tanh."""
        constants = beside([constants_of(mlp, settings) for mlp in cls.plain(networks)])
        first, second = constants.first, constants.second

        def matrix(
            name: str, layer: Layer, in_fmt: Fix, out_fmt: Fix, biases: tuple[int, ...]
        ) -> ConstantMatrix:
            return ConstantMatrix(
                in_fmt,
                out_fmt,
                layer.weights,
                biases,
                in_fmt.frac + layer.fmt.frac - out_fmt.frac,
                GUARD,
                variant=name,
                **adders,
            )

        frac = EXACT.hidden_fmt.frac
        biases = tuple(bias << SIGNAL.frac for bias in first.biases)
        width = _width(first.weights, biases, SIGNAL.frac + first.fmt.frac - frac)
        hidden = matrix("hidden", first, SIGNAL, Fix(width, frac), biases)
        # The bias makes up for half a step of each r, and rounds the output with half a step of its
        # own.
        half = (1 << RESULT.frac + second.fmt.frac - SIGNAL.frac) >> 1
        biases = tuple(
            (bias << RESULT.frac) + (sum(row) >> 1) + half
            for row, bias in zip(second.weights, second.biases, strict=True)
        )
        outputs = matrix("outputs", second, RESULT, SIGNAL, biases)
        found = [one for one in constants.activations if isinstance(one, Bipartite)]
        activations = tabled(found, hidden.result_widths)
        return cls(
            (hidden, outputs),
            (activations,),
            useless_nodes=constants.useless_nodes,
            variant=variant,
        )

    @property
    def groups(self) -> tuple[tuple[tuple[int, ...], ...], ...]:
        """For each hidden layer, the nodes that share their tables; none without tables."""
        pairs = zip(self.layers, self.activations, strict=False)
        return tuple(groups_of(tables, matrix.result_widths) for matrix, tables in pairs)

    def shared(self, layer: int, nodes: tuple[int, ...]) -> Bipartite | BipartitePair:
        """The block that computes the activation of the given nodes of a hidden layer."""
        activation = self.activations[layer][nodes[0]]
        if len(nodes) == NODES:
            return BipartitePair(activation, variant=activation.variant)
        return activation

    @property
    def inputs(self) -> int:
        return self.layers[0].inputs

    @property
    def outputs(self) -> int:
        return len(self.layers[-1].weights)

    @property
    def latency(self) -> int:
        tables = sum(tables[0].latency for tables in self.activations if tables)
        return tables + sum(matrix.latency for matrix in self.layers)

    def left_out(self) -> list[str]:
        texts = self.left_out_of([table for tables in self.activations for table in tables])
        if self.constant_nodes:
            texts.append(f"{self.constant_nodes} hidden nodes that never change, now in biases")
        return [*texts, "every multiplier: a weight is a few shifted adds, shared with others"]

    def flow(self) -> Flow:
        steps: list[Step] = [Wire(f"{self.inputs} x", SIGNAL)]
        for n, (matrix, activations) in enumerate(zip(self.layers, self.activations, strict=False)):
            steps += [matrix, Wire(f"{len(matrix.weights)} q", matrix.out_fmt)]
            if activations:
                tables = tuple(self.shared(n, nodes) for nodes in self.groups[n])
                steps += [Replicated(tables), Wire(f"{len(activations)} r", RESULT)]
        outputs = self.layers[-1]
        steps += [outputs, Wire(f"{self.outputs} y", outputs.out_fmt)]
        return Flow(tuple(steps), across=True)

    def compute(self, frames: Codes) -> Codes:
        return self.layers[-1].process(self._taken(frames)[-1])

    def saturations(self, frames: Codes) -> dict[str, Codes]:
        names = [one.layer for one in self.ranges if one.from_data]
        found = {name: np.zeros(len(frames), dtype=np.int64) for name in names}
        for start in range(0, len(frames) if names else 0, CHUNK):
            part = slice(start, start + CHUNK)
            taken = zip(self.layers, self._taken(frames[part]), strict=True)
            for number, (matrix, codes) in enumerate(taken, start=1):
                if (name := layer_name(number)) in found:
                    found[name][part] += _beyond(matrix, codes)
        return found

    def _taken(self, frames: Codes) -> list[Codes]:
        """What each matrix takes, layer by layer."""
        found = [frames]
        for matrix, tables in zip(self.layers, self.activations, strict=False):
            codes = matrix.process(found[-1])
            if tables:
                columns = [table.process(codes[:, j]) for j, table in enumerate(tables)]
                codes = np.stack(columns, axis=-1)
            found.append(codes)
        return found


def _beyond(matrix: ConstantMatrix, codes: Codes) -> Codes:
    """How many sums of each frame saturate; a negative one that becomes 0 does not."""
    words, low = np.stack(matrix.words(codes.T), axis=-1), np.array(matrix.result_lows)
    beyond = (words > matrix.out_fmt.high) | ((words < low) & (low < 0))
    # Of the two rows of a leaky ReLU, the one that is not rectified counts.
    plain = low < 0
    counts: Codes = beyond[:, plain if plain.any() else ~plain].sum(axis=-1)
    return counts


def beside(networks: Sequence[Constants]) -> Constants:
    """Join networks of the same inputs; each output has weights for its own hidden nodes only."""
    firsts, seconds = ([getattr(c, name) for c in networks] for name in ("first", "second"))
    hidden = [len(layer.biases) for layer in firsts]
    first, second = _stacked(firsts), _stacked(seconds)
    rows = iter(second.weights)
    weights = tuple(
        (0,) * sum(hidden[:n]) + next(rows) + (0,) * sum(hidden[n + 1 :])
        for n, layer in enumerate(seconds)
        for _ in layer.biases
    )
    return replace(
        networks[0],
        first=first,
        second=replace(second, weights=weights),
        activations=tuple(a for c in networks for a in c.activations),
        useless_nodes=sum(c.useless_nodes for c in networks),
    )


def _stacked(layers: Sequence[Layer]) -> Layer:
    """The neurons of all layers, in a format with the largest number of fraction bits of them."""
    frac = max(layer.fmt.frac for layer in layers)
    width = max(layer.fmt.width + frac - layer.fmt.frac for layer in layers)
    moved = [(layer, frac - layer.fmt.frac) for layer in layers]
    return Layer(
        tuple(tuple(w << by for w in row) for layer, by in moved for row in layer.weights),
        tuple(bias << by for layer, by in moved for bias in layer.biases),
        Fix(width, frac),
        tuple(factor for layer in layers for factor in layer.factors),
    )


def _width(weights: Sequence[Sequence[int]], biases: Sequence[int], shift: int) -> int:
    """Bits that the sums of all rows need without their last ``shift`` bits, however cut."""
    most = max(
        sum(map(abs, row)) * -SIGNAL.low + abs(bias)
        for row, bias in zip(weights, biases, strict=True)
    )
    return signed_width([(most >> shift) + 1])
