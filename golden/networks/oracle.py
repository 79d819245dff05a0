"""The results that a design must give, in unlimited integers, and bounds on their error.

Nothing here is shared, folded or cut as it is in hardware, so the two can be compared.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import singledispatch

import numpy as np

from golden.activation.activation_block import ActivationBlock
from golden.common.block import Block, walk
from golden.engine.integer_network import evaluate
from golden.layers.constant_matrix import ConstantMatrix
from golden.layers.weighted_sum import WeightedSum
from golden.networks.adder_graph import AdderGraph
from golden.networks.bounds import (
    activation_error,
    built_nodes,
    engine_bounds,
    layered_bounds,
    two_layer_bounds,
)
from golden.networks.constants import Layer, quantised
from golden.networks.design import Design
from golden.networks.engine import Engine
from golden.networks.hybrid import Hybrid
from golden.networks.learning_engine import LearningEngine
from golden.networks.parallel import Parallel
from golden.numbers.fixed import Codes
from golden.numbers.precision import Precision
from golden.numbers.real import Real
from golden.trained.dense import DenseNetwork, Trained
from golden.trained.mlp import Mlp


@dataclass(frozen=True)
class ExactSum:
    """One neuron's sum, computed in integers of unlimited width.

    factor: Factor by which the sum is multiplied.
    """

    formats: WeightedSum
    weights: Sequence[int]
    bias: int
    factor: int = 1

    def process(self, frames: Codes) -> Codes:
        """The neuron's result for every frame."""
        results = (
            exact_sum(self.formats, self.weights, self.bias, frame, self.factor)[1]
            for frame in frames.tolist()
        )
        return np.array(list(results), dtype=np.int64)


@dataclass(frozen=True)
class ExactLayers:
    """A network of two layers as sums and activations.

    activations: One per hidden node.
    """

    hidden: list[ExactSum]
    activations: tuple[ActivationBlock, ...]
    outputs: list[ExactSum]

    def process(self, frames: Codes) -> Codes:
        """Output codes; activations are computed by parts, not read from tables of results."""
        pairs = zip(self.hidden, self.activations, strict=True)
        r = np.stack([activation.compute(one.process(frames)) for one, activation in pairs], axis=1)
        return np.stack([one.process(r) for one in self.outputs], axis=1)


def exact_sum(
    formats: WeightedSum, weights: Sequence[int], bias: int, samples: Iterable[int], factor: int = 1
) -> tuple[int, int]:
    """The sum of a neuron, and its result, which is rounded half up and saturated."""
    products = (w * x >> formats.product_shift for w, x in zip(weights, samples, strict=True))
    total = (bias << formats.bias_shift) + sum(products)
    shift = formats.out_shift
    result = (total * factor + ((1 << shift) >> 1)) >> shift
    return total, max(formats.out_fmt.low, min(formats.out_fmt.high, result))


def designs_in(network: Block) -> list[Design]:
    """The designs inside a network, in the order of the outputs.

    For an engine that learns it is the one that computes the same before anything is learned.
    """
    found = [part.engine if isinstance(part, LearningEngine) else part for part in walk(network)]
    return [part for part in found if isinstance(part, Design)]


@singledispatch
def exact_layers(design: Design) -> ExactLayers:
    """The sums and activations of a design of two layers."""
    raise NotImplementedError(f"{design.block}: its exact layers are not known")


@exact_layers.register
def _(design: Hybrid) -> ExactLayers:
    first, last = design.input_integral, design.output_integral
    factors = last.factors or (1,) * last.outputs
    return ExactLayers(
        [ExactSum(first, *row) for row in zip(first.weights, first.biases, strict=True)],
        design.activations,
        [ExactSum(last, *row) for row in zip(last.weights, last.biases, factors, strict=True)],
    )


@exact_layers.register
def _(design: Parallel) -> ExactLayers:
    hidden, outputs = (
        [ExactSum(n, n.weights, n.bias, n.factor or 1) for n in neurons]
        for neurons in (design.hidden_neurons, design.output_neurons)
    )
    return ExactLayers(hidden, design.activations, outputs)


@singledispatch
def exact(design: Design, frames: Codes) -> Codes:
    """Output codes, computed layer by layer in unlimited integers."""
    return exact_layers(design).process(frames)


@exact.register
def _(design: Engine, frames: Codes) -> Codes:
    return evaluate(design.integers, frames)


@exact.register
def _(design: AdderGraph, frames: Codes) -> Codes:
    *hidden, outputs = design.layers
    codes = frames
    for matrix, tables in zip(hidden, design.activations, strict=True):
        codes = matrix.exact(codes)
        if tables:
            columns = [table.compute(codes[:, j]) for j, table in enumerate(tables)]
            codes = np.stack(columns, axis=-1)
    return outputs.exact(codes)


@singledispatch
def hidden_weights(design: Design) -> list[Sequence[int]]:
    """A code per input of each sum of the samples; their signs tell which drive it to an end.

    These are the hidden sums or, without a hidden layer, the outputs.
    """
    return [node.weights for node in exact_layers(design).hidden]


@hidden_weights.register
def _(design: Engine) -> list[Sequence[int]]:
    graph = design.graph
    return [
        [sum(t.weight for t in neuron.terms if t.source == k) for k in range(design.inputs)]
        for neuron in graph.first_sums or [n for n in graph.neurons if n.output]
    ]


@hidden_weights.register
def _(design: AdderGraph) -> list[Sequence[int]]:
    return list(design.layers[0].weights)


@singledispatch
def error_bounds(
    design: Design, mlp: Trained, precision: Precision, sensors: int, met: Sequence[float] = ()
) -> Real:
    """How far each output can be from real arithmetic that saturates, in real units.

    mlp: The network of the design.
    sensors: How many inputs are samples; the others are outputs of earlier networks.
    met: Where the ranges of layers are from the data; see ``golden.engine.quantise.planned``.
    """
    assert isinstance(mlp, Mlp)
    return two_layer_bounds(mlp, precision, exact_layers(design).activations)


@error_bounds.register
def _(
    design: Engine,
    mlp: Trained,
    _precision: Precision,
    sensors: int,
    met: Sequence[float] = (),
) -> Real:
    return engine_bounds(mlp, design.program.segment_width, sensors, met)


@error_bounds.register
def _(
    design: AdderGraph,
    mlp: Trained,
    precision: Precision,
    _sensors: int,
    met: Sequence[float] = (),
) -> Real:
    if isinstance(mlp, DenseNetwork):
        return layered_bounds(mlp, design.layers, design.activations, met)
    # ConstantMatrix.errors is the part of the error that comes from dropped bits.
    first = quantised(mlp.w1, mlp.b1, precision, "layer 1 weights")
    second = quantised(mlp.w2, mlp.b2, precision, "layer 2 weights")
    (hidden, outputs), (activations,) = design.layers, design.activations
    built = built_nodes(second, len(activations))
    q_off = _off(mlp.w1[built], mlp.b1[built], first.of_neurons(built), hidden)
    r_off = q_off + [activation_error(a, 1) for a in activations]
    y_off = _off(mlp.w2, mlp.b2, second, outputs)
    result: Real = y_off + np.abs(mlp.w2[:, built]) @ r_off
    return result


def _off(weights: Real, biases: Real, layer: Layer, matrix: ConstantMatrix) -> Real:
    """How far each result can be from the real sum of samples of magnitude 1 at most.

    The error has three parts: the rounding of weights and bias; the bits that are dropped in the
    sum, with one unit more for the halves that its constant loses; and half a step of the result.
    """
    rounding = np.abs(weights - layer.fmt.to_real(layer.weights)).sum(axis=1)
    rounding += np.abs(biases - layer.fmt.to_real(layer.biases))
    units = np.array([max(map(abs, ends)) + 1 for ends in matrix.errors], dtype=np.float64)
    step = 2.0**-matrix.out_fmt.frac
    result: Real = rounding + (units / 2.0**matrix.out_shift + 0.5) * step
    return result
