"""Adder graph: a network of two layers without a multiplier, which takes a frame every clock."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from golden.activation.activation_block import ActivationBlock
from golden.activation.bipartite import Bipartite
from golden.activation.bipartite_pair import NODES, BipartitePair, pair_for
from golden.activation.bipartite_table import RESULT
from golden.block import Block
from golden.dense import Trained
from golden.fixed import Codes, Fix, signed_width
from golden.input_error import InputError
from golden.layers.constant_matrix import ConstantMatrix
from golden.layers.input_controller import InputController
from golden.networks.constants import Constants, Layer, constants_of
from golden.networks.design import Design
from golden.networks.settings import Settings
from golden.precision import EXACT, SIGNAL

# The most adders between two registers, where a scene does not set it.
ADDERS_PER_CLOCK = 5
# Bits below the last place of q and of y that take part in the additions.
GUARD = (1, 1)


@dataclass(frozen=True)
class AdderGraph(Design):
    """y = f2(tanh(f1(x))); shifted adds form all sums of a layer together, without a multiplier.

    Parameters
    ----------
    first : ConstantMatrix
        A row for each hidden node; its result has as many bits of q as its sum can need.
    activations : tuple of Bipartite
        One per hidden node.
    second : ConstantMatrix
        A row for each output.

    Notes
    -----
    A code of q or r stands for the middle of its step. So q is rounded down, and half the sum of an
    output's weights is part of that output's bias. The output is rounded half up.
    """

    block = "adder_graph"
    arrangements = together = ("single", "multiple")
    precisions = (EXACT.name,)
    known_activations = ("bipartite",)
    half_codes = True
    options = ("adders_per_clock",)
    stream = "words"
    first: ConstantMatrix
    activations: tuple[Bipartite, ...]
    second: ConstantMatrix

    def __post_init__(self) -> None:
        rows = len(self.first.weights)
        if not rows == len(self.activations) == self.second.inputs:
            raise InputError(
                f"{self.entity}: got {rows} hidden sums, {len(self.activations)} activations and "
                f"{self.second.inputs} weights per output, expected equal numbers"
            )

    @classmethod
    def build(
        cls, networks: Sequence[Trained], settings: Settings, arrangement: str, variant: str
    ) -> Self:
        chosen: dict[str, Any] = {"adders_per_clock": ADDERS_PER_CLOCK, **settings.options}
        adders_per_clock = chosen["adders_per_clock"]
        constants = beside([constants_of(mlp, settings) for mlp in cls.plain(networks)])
        prefix = f"{variant}_" if variant else ""
        first, second = constants.first, constants.second
        frac = EXACT.hidden_fmt.frac
        shift = SIGNAL.frac + first.fmt.frac - frac
        biases = tuple(bias << SIGNAL.frac for bias in first.biases)
        hidden = ConstantMatrix(
            SIGNAL,
            Fix(_width(first.weights, biases, shift), frac),
            first.weights,
            biases,
            shift,
            GUARD[0],
            adders_per_clock,
            variant=f"{prefix}hidden",
        )
        # The bias makes up for half a step of each r, and rounds the output with half a step of its
        # own.
        shift = RESULT.frac + second.fmt.frac - SIGNAL.frac
        biases = tuple(
            (bias << RESULT.frac) + (sum(row) >> 1) + ((1 << shift) >> 1)
            for row, bias in zip(second.weights, second.biases, strict=True)
        )
        outputs = ConstantMatrix(
            RESULT,
            SIGNAL,
            second.weights,
            biases,
            shift,
            GUARD[1],
            adders_per_clock,
            variant=f"{prefix}outputs",
        )
        widths = hidden.result_widths
        activations = [_halved(activation) for activation in constants.activations]
        for nodes in _groups(activations, widths):
            least = activations[nodes[0]].formats.group_width + 2
            width = max(least, *(widths[j] for j in nodes))
            for j in nodes:
                activations[j] = activations[j].taking(width)
        return cls(
            hidden,
            tuple(activations),
            outputs,
            useless_nodes=constants.useless_nodes,
            variant=variant,
        )

    @property
    def groups(self) -> tuple[tuple[int, ...], ...]:
        """The hidden nodes that share their tables."""
        return _groups(self.activations, self.first.result_widths)

    def shared(self, nodes: tuple[int, ...]) -> Bipartite | BipartitePair:
        """The block that computes the activation of the given nodes."""
        activation = self.activations[nodes[0]]
        return pair_for(activation) if len(nodes) == NODES else activation

    @property
    def inputs(self) -> int:
        return self.first.inputs

    @property
    def outputs(self) -> int:
        return len(self.second.weights)

    @property
    def unreachable(self) -> dict[str, str]:
        return {"frame_error=1": "a frame a clock is never too close"}

    @property
    def interval(self) -> int:
        return self.min_interval

    @property
    def latency(self) -> int:
        return self.first.latency + self.activations[0].latency + self.second.latency

    @property
    def input_controller(self) -> InputController:
        """A frame is one element and always good, so no hardware decides about it."""
        return InputController(1, 0)

    def parts(self) -> tuple[Block, ...]:
        return (self.first, *(self.shared(nodes) for nodes in self.groups), self.second)

    def compute(self, frames: Codes) -> Codes:
        q = self.first.process(frames)
        columns = [a.process(q[:, j]) for j, a in enumerate(self.activations)]
        return self.second.process(np.stack(columns, axis=-1))


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


def _halved(activation: ActivationBlock) -> Bipartite:
    if not isinstance(activation, Bipartite):
        raise InputError(f"adder_graph: got activation {activation.block!r}, expected 'bipartite'")
    return activation


def _width(weights: Sequence[Sequence[int]], biases: Sequence[int], shift: int) -> int:
    """Bits that the sums of all rows need without their last ``shift`` bits, however cut."""
    most = max(
        sum(map(abs, row)) * -SIGNAL.low + abs(bias)
        for row, bias in zip(weights, biases, strict=True)
    )
    return signed_width([(most >> shift) + 1])


def _groups(activations: Sequence[Bipartite], widths: Sequence[int]) -> tuple[tuple[int, ...], ...]:
    """The nodes that share their tables. In block RAM two nodes of similar width form a group."""
    count = NODES if activations[0].memory == "block_ram" else 1
    order = sorted(range(len(widths)), key=lambda j: (widths[j], j))
    return tuple(tuple(order[n : n + count]) for n in range(0, len(order), count))
