"""Turns a trained network into the constants from which every design of hardware is built."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from golden.activation.activation_block import ActivationBlock
from golden.activation.schemes import SCHEMES
from golden.input_error import InputError
from golden.layers.weighted_sum import RowSums
from golden.networks.design import Settings
from golden.numbers.fixed import Fix, signed_width
from golden.numbers.precision import SIGNAL, Precision, normalisation
from golden.trained.dense import Dense, DenseNetwork


@dataclass(frozen=True)
class Layer:
    """A layer in codes: weights, shape (neurons, inputs), biases, format, and factors Q or Y."""

    weights: tuple[tuple[int, ...], ...]
    biases: tuple[int, ...]
    fmt: Fix
    factors: tuple[int, ...]

    def of_neurons(self, kept: Sequence[int]) -> Layer:
        """This layer with only some of its neurons."""
        return replace(
            self,
            weights=tuple(self.weights[j] for j in kept),
            biases=tuple(self.biases[j] for j in kept),
            factors=tuple(self.factors[j] for j in kept),
        )


def quantised(layer: Dense, precision: Precision, name: str) -> Layer:
    """A layer in the formats of a precision, normalised where the precision demands it."""
    weights, biases = layer.weights, layer.biases
    factors = (
        normalisation(weights, biases, name)
        if precision.normalise
        else np.ones(len(biases), dtype=np.int64)
    )
    try:
        codes, bias_codes, fmt = precision.coefficients(
            weights / factors[:, np.newaxis], biases / factors, name
        )
    except InputError as error:
        raise InputError(
            f"{error}; more training.weight_decay keeps them small, and so does a data.scale "
            "nearer to the readings"
        ) from None
    rows = tuple(map(tuple, codes.tolist()))
    return Layer(rows, tuple(bias_codes.tolist()), fmt, tuple(factors.tolist()))


def layers_in_codes(mlp: DenseNetwork, precision: Precision) -> tuple[Layer, Layer]:
    """Both layers of a network of one hidden layer, with all of its nodes."""
    first, second = mlp.layers
    return (
        quantised(first, precision, "layer 1 weights"),
        quantised(second, precision, "layer 2 weights"),
    )


@dataclass(frozen=True)
class Constants:
    """A network of two layers in codes, and the activation of each hidden node.

    first, second: The layers without the hidden nodes that are not built.
    activations: One per hidden node.
    useless_nodes: Hidden nodes that are not built, because no output uses them.
    """

    precision: Precision
    first: Layer
    second: Layer
    activations: tuple[ActivationBlock, ...]
    useless_nodes: int


def constants_of(mlp: DenseNetwork, settings: Settings) -> Constants:
    """Quantise a trained network and choose its activations; every design takes what comes out.

    settings: Those of the precision and the activation matter.

    A weight whose code is 0 adds nothing to a sum, so a node whose weights to the outputs are all 0
    changes no output. One node is always built, because a network has at least one.
    """
    precision, lean = settings.precision, settings.lean
    first, second = layers_in_codes(mlp, precision)
    hidden = range(len(first.biases))
    used = used_nodes(second) if lean else list(hidden)
    first = first.of_neurons(used)
    second = replace(second, weights=tuple(tuple(row[j] for j in used) for row in second.weights))
    # The bounds of the sums of a layer are the same in every design.
    nodes, outputs = (
        RowSums(SIGNAL, one.fmt, fmt, precision.product_shift, one.weights, one.biases)
        for one, fmt in ((first, precision.hidden_fmt), (second, SIGNAL))
    )
    # The thesis' adders would wrap a sum that is too wide, and a wrapped sum is wrong.
    named = [(f"hidden node {j}", ends) for j, ends in enumerate(nodes.sum_ranges)]
    for name, ends in (*named, *(("output layer", ends) for ends in outputs.sum_ranges)):
        if precision.normalise and signed_width(ends) > SIGNAL.width:
            raise InputError(
                f"{name}: its normalised sum needs {signed_width(ends)} bits and would wrap in "
                f"{SIGNAL.width}; weights that are nearly whole numbers do this, retrain or "
                "use the exact precision"
            )
    scheme = SCHEMES[settings.activation].configured(settings.activation_options)
    activations = tuple(
        scheme.build(precision, q, reach if lean else precision.hidden_fmt.high)
        for q, reach in zip(first.factors, nodes.reaches, strict=True)
    )
    return Constants(precision, first, second, activations, len(hidden) - len(used))


def used_nodes(second: Layer) -> list[int]:
    """The hidden nodes that some output uses; the first alone if none does."""
    found = [j for j in range(len(second.weights[0])) if any(row[j] for row in second.weights)]
    return found or [0]
