"""Adder graph: a network of two layers without a multiplier, a frame every clock."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
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
from golden.flow import Alike, Carried, Flow
from golden.input_error import InputError
from golden.layers.constant_matrix import ConstantMatrix
from golden.layers.input_controller import InputController
from golden.mlp import Mlp
from golden.networks.bounds import activation_error
from golden.networks.constants import Constants, Layer, constants_of, quantised
from golden.networks.design import Design
from golden.precision import EXACT, SIGNAL, Precision
from golden.real import Real

# Adders between two registers, where a scene says nothing.
ADDERS_PER_CLOCK = 5
# Places below the last of q and of y that are added.
GUARD = (1, 1)


@dataclass(frozen=True)
class AdderGraph(Design):
    """y = f2(tanh(f1(x))), every sum of a layer in one graph of shifted adds, none multiplied.

    Parameters
    ----------
    first : ConstantMatrix
        A row for each hidden node, with as many bits of q as its sum can have.
    activations : tuple of Bipartite
        One per hidden node.
    second : ConstantMatrix
        A row for each output.

    Notes
    -----
    A code of q and of r stands for the middle of its step: so q is floored, and half the sum of
    its weights is part of an output's bias. That is rounded half up, the output too.
    """

    block = "adder_graph"
    arrangements = ("single", "multiple")
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
    def of(
        cls,
        network: Trained,
        precision: Precision,
        activation: str,
        options: Mapping[str, object] | None = None,
        variant: str = "",
        lean: bool = True,
        hardware: Mapping[str, object] | None = None,
    ) -> Self:
        constants = constants_of(cls.plain(network), precision, activation, options, lean)
        return cls.from_constants(constants, variant, **_chosen(hardware))

    @classmethod
    def of_several(
        cls,
        arrangement: str,
        networks: Sequence[Trained],
        lean: bool = True,
        hardware: Mapping[str, object] | None = None,
        activation_options: Mapping[str, object] | None = None,
    ) -> Self | None:
        if arrangement == "single":
            return None
        mlps = map(cls.plain, networks)
        found = [constants_of(m, EXACT, "bipartite", activation_options, lean) for m in mlps]
        return cls.from_constants(beside(found), **_chosen(hardware))

    @classmethod
    def from_constants(
        cls, constants: Constants, variant: str = "", adders_per_clock: int = ADDERS_PER_CLOCK
    ) -> Self:
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
        # Half a step of each r, and of the output.
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
        """What computes the activation of some nodes."""
        activation = self.activations[nodes[0]]
        return pair_for(activation) if len(nodes) == NODES else activation

    @property
    def inputs(self) -> int:
        return self.first.inputs

    @property
    def outputs(self) -> int:
        return len(self.second.weights)

    @property
    def hidden_weights(self) -> list[Sequence[int]]:
        return list(self.first.weights)

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
        """A frame is one element, and good: no hardware decides."""
        return InputController(1, 0)

    def parts(self) -> tuple[Block, ...]:
        return (self.first, *(self.shared(nodes) for nodes in self.groups), self.second)

    def flow(self) -> Flow:
        hidden = len(self.activations)
        return Flow(
            (
                Carried(f"{self.inputs} x", self.first.in_fmt),
                self.first,
                Carried(f"{hidden} q", self.first.out_fmt),
                Alike(tuple(self.shared(nodes) for nodes in self.groups)),
                Carried(f"{hidden} r", self.second.in_fmt),
                self.second,
                Carried(f"{self.outputs} y", self.second.out_fmt),
            ),
            across=True,
        )

    def left_out(self) -> list[str]:
        counts: Counter[str] = sum((a.left_out() for a in self.activations), Counter())
        texts = [f"{count} {what}" for what, count in sorted(counts.items())]
        if self.useless_nodes:
            texts.append(f"{self.useless_nodes} hidden nodes whose weights to the outputs are 0")
        return [*texts, "every multiplier: a weight is a few shifted adds, shared with others"]

    def compute(self, frames: Codes) -> Codes:
        q = self.first.process(frames)
        columns = [a.process(q[:, j]) for j, a in enumerate(self.activations)]
        return self.second.process(np.stack(columns, axis=-1))

    def exact(self, frames: Codes) -> Codes:
        q = self.first.exact(frames)
        columns = [a.compute(q[:, j]) for j, a in enumerate(self.activations)]
        return self.second.exact(np.stack(columns, axis=-1))

    def error_bounds(self, mlp: Mlp, precision: Precision, sensors: int) -> Real:
        """See ``Design``; what cutting adds is ``ConstantMatrix.errors``."""
        first = quantised(mlp.w1, mlp.b1, precision, "layer 1 weights")
        second = quantised(mlp.w2, mlp.b2, precision, "layer 2 weights")
        q_off = _off(mlp.w1, mlp.b1, first, self.first)
        r_off = q_off + [activation_error(a, 1) for a in self.activations]
        y_off = _off(mlp.w2, mlp.b2, second, self.second)
        result: Real = y_off + np.abs(mlp.w2) @ r_off
        return result


def _chosen(hardware: Mapping[str, object] | None) -> dict[str, Any]:
    """What a scene chooses of the options."""
    return dict(hardware or {})


def beside(networks: Sequence[Constants]) -> Constants:
    """Networks of the same inputs as one: all hidden nodes, of which each output sees its own."""
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
    """The neurons of all layers, with the fraction bits of the one that has the most."""
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
    """Bits of the sums of all rows, less their last ``shift``, whatever cutting does to them."""
    most = max(
        sum(map(abs, row)) * -SIGNAL.low + abs(bias)
        for row, bias in zip(weights, biases, strict=True)
    )
    return signed_width([(most >> shift) + 1])


def _groups(activations: Sequence[Bipartite], widths: Sequence[int]) -> tuple[tuple[int, ...], ...]:
    """The nodes whose tables are shared: two of about the same width at a time, in block RAM."""
    count = NODES if activations[0].memory == "block_ram" else 1
    order = sorted(range(len(widths)), key=lambda j: (widths[j], j))
    return tuple(tuple(order[n : n + count]) for n in range(0, len(order), count))


def _off(weights: Real, biases: Real, layer: Layer, matrix: ConstantMatrix) -> Real:
    """How far each result can be from the real sum of samples of magnitude 1 at most.

    What rounding took from weights and bias, what cutting moves, and half a step of the result,
    with one unit of the sum for the halves that its constant loses.
    """
    taken = np.abs(weights - layer.fmt.to_real(layer.weights)).sum(axis=1)
    taken += np.abs(biases - layer.fmt.to_real(layer.biases))
    units = np.array([max(map(abs, ends)) + 1 for ends in matrix.errors], dtype=np.float64)
    step = 2.0**-matrix.out_fmt.frac
    result: Real = taken + (units / 2.0**matrix.out_shift + 0.5) * step
    return result
