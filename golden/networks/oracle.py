"""The results that a design must give, in unlimited integers, and bounds on their error.

Nothing here is shared, folded or cut as it is in hardware, so the two can be compared.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import lru_cache, singledispatch
from typing import NamedTuple

import numpy as np

from golden.activation.activation_block import ActivationBlock
from golden.common.block import Block, walk
from golden.engine.formats import HIDDEN, ONE, RESULT, coeff_frac
from golden.engine.function_table import table_of
from golden.engine.grid import Value
from golden.engine.integer_network import evaluate
from golden.engine.quantise import PlannedLayer, first_values, planned
from golden.layers.constant_matrix import ConstantMatrix
from golden.layers.weighted_sum import WeightedSum
from golden.networks.adder_graph import AdderGraph
from golden.networks.constants import Layer, layers_in_codes, used_nodes
from golden.networks.design import Design
from golden.networks.engine import Engine
from golden.networks.hybrid import Hybrid
from golden.networks.learning_engine import LearningEngine
from golden.networks.parallel import Parallel
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL, Precision
from golden.numbers.real import Real
from golden.trained.dense import Dense, DenseNetwork
from golden.trained.function import Function


def two_layer_bounds(
    mlp: DenseNetwork,
    precision: Precision,
    activations: Sequence[ActivationBlock],
    off: Callable[[int, Dense, Layer], Real],
) -> Real:
    """The bound of the error of each output.

    Saturation increases no difference between two values, and tanh has no slope above 1. So the
    bound of y is the error of the sums in layer 2, plus ``|w2|`` times the error of r, which comes
    from the activation and from the sum q. The weights of a node that is not built are rounded to
    0, so it is part of the error of rounding alone.

    off: How far the sums of a layer are from real ones, for the number of the layer, its real
        weights and its codes.
    """
    hidden, outputs = mlp.layers
    first, second = layers_in_codes(mlp, precision)
    every = list(range(len(second.weights[0])))
    built = every if len(every) == len(activations) else used_nodes(second)
    hidden = replace(hidden, weights=hidden.weights[built], biases=hidden.biases[built])
    first = first.of_neurons(built)
    pairs = zip(activations, first.factors, strict=True)
    r_off = off(0, hidden, first) + [activation_error(*pair) for pair in pairs]
    result: Real = off(1, outputs, second) + np.abs(outputs.weights[:, built]) @ r_off
    return result


def engine_bounds(
    network: DenseNetwork, segment_width: int, sensors: int, met: Sequence[float] = ()
) -> Real:
    """How far each output of a network in an engine can be from real arithmetic that saturates.

    Real arithmetic saturates the sum in front of each table, and the output, where the engine does.
    Behind a table the error of a sum is multiplied by the steepest slope of the function, and the
    error of the table is added.

    sensors: How many inputs are samples; the others are outputs of earlier networks.
    met: See ``planned``, and ``_through`` for the frames for which the bounds hold.

    The operand memory keeps an earlier output, which a later network reads, with four bits more
    than leave the engine. So this word lies up to half a unit of 2**-13 and one of 2**-17 from the
    output's code.
    """
    seen = 2.0 ** -(SIGNAL.frac + 1) + 2.0**-RESULT.frac
    values = first_values(sensors, network.shape[0] - sensors)

    def add(_: int, one: PlannedLayer, errors: Real, off: Real) -> Real:
        exact, layer = one[:2]
        frac = SIGNAL.frac if exact.output else layer.result.frac
        off = off + 2.0 ** -(frac + 1)
        off += [
            sum(
                _steepest(function) * errors[word] + table_of(function, segment_width).error
                for word, function in layer.added_to(node)
            )
            for node in range(layer.nodes)
        ]
        if layer.functions:
            tables = [table_of(function, segment_width).error for function in layer.functions]
            off = off * [_steepest(function) for function in layer.functions] + tables
        # The largest word is one unit below 1.
        return off + 2.0**-frac * (exact.activation == "hard_tanh")

    return _through(network, values, met, np.array([seen * v.earlier for v in values]), add)


def layered_bounds(
    network: DenseNetwork,
    layers: Sequence[ConstantMatrix],
    activations: Sequence[Sequence[ActivationBlock]],
    met: Sequence[float] = (),
) -> Real:
    """The same for a network in matrices and tables.

    To the error of a sum that of the bits that are cut is added, that of rounding the result, and
    behind a table its error.
    """
    tables = [*activations, ()]

    def add(number: int, one: PlannedLayer, _: Real, off: Real) -> Real:
        matrix = layers[number]
        units = max(max(map(abs, ends)) for ends in matrix.errors) + 1
        step = 2.0**-matrix.out_fmt.frac
        off = off + (units / 2.0**matrix.out_shift + 0.5) * step
        off = off + max((activation_error(table, 1) for table in tables[number]), default=0.0)
        # The largest word is a step below 1.
        return off + step * (one[0].activation == "hard_tanh")

    values = first_values(network.shape[0], 0)
    return _through(network, values, met, np.zeros(len(values)), add)


def _through(
    network: DenseNetwork,
    values: list[Value],
    met: Sequence[float],
    errors: Real,
    add: Callable[[int, PlannedLayer, Real, Real], Real],
) -> Real:
    """The bounds of the error of each output, layer by layer.

    The error of a sum is that of its operands, times their weights, plus the error of the rounded
    weights and bias. No activation without a table has a slope above 1. A quantiser is exact where
    its operands are; where they are not, it can be a whole step off.

    Where the range of a layer is from the data (``met``), the bounds hold only for frames in which
    none of its sums saturates, which ``Network.saturations`` tells. For any other frame there is no
    bound. Where all ranges are from bounds, they hold for every frame.

    values, errors: The operands of the first layer, and how far each is off.
    add: The error of a layer's results, for its number, its plan, and the errors of operands and of
        sums.
    """
    off = errors
    for number, one in enumerate(planned(network, values, met)):
        exact, layer, after = one
        result = layer.result
        weights = np.array(
            [[abs(float(row[v.node] * v.factor)) for v in values] for row in exact.weights]
        )
        off = weights @ errors
        if exact.grid:
            off = np.where(off > 0, off + 2.0 ** (exact.grid.cut - result.frac), 0.0)
        else:
            reached = [max(-v.low, v.high) * 2.0**-v.fmt.frac for v in values]
            halves = [2.0 ** -(coeff_frac(result, v.fmt) + 1) for v in values]
            off = off + np.dot(halves, reached) + 2.0 ** -(coeff_frac(result, ONE) + 1)
            off = add(number, one, errors, off)
        values = after
        errors = off[[value.node for value in values]]
    return off


@lru_cache
def _steepest(function: Function) -> float:
    """The largest slope of a function over the codes of q."""
    q = HIDDEN.to_real(np.arange(HIDDEN.low, HIDDEN.high + 1))
    return float(np.abs(np.diff(function.value(q))).max() * 2.0**HIDDEN.frac)


def _rounded(real: Dense, layer: Layer, precision: Precision, out_frac: int) -> Real:
    """How far a layer's sums can be off for samples of magnitude 1 at most, shape (neurons,).

    The error has three parts: the rounding of weights and bias, one LSB for each product from which
    bits are dropped, and half an LSB of the result.
    """
    factors = np.asarray(layer.factors, dtype=np.float64)
    total = _coefficients_off(real, layer)
    acc_frac = SIGNAL.frac + layer.fmt.frac - precision.product_shift
    cut = real.weights.shape[1] * 2.0**-acc_frac if precision.product_shift else 0.0
    half = 2.0 ** -(out_frac + 1) if acc_frac > out_frac else 0.0
    result: Real = total + factors * (cut + half)
    return result


def _coefficients_off(real: Dense, layer: Layer) -> Real:
    """How far rounded weights and biases put sums off, shape (neurons,)."""
    factors = np.asarray(layer.factors, dtype=np.float64)
    off: Real = np.abs(real.weights - factors[:, np.newaxis] * layer.fmt.to_real(layer.weights))
    return off.sum(axis=1) + np.abs(real.biases - factors * layer.fmt.to_real(layer.biases))


@lru_cache(maxsize=256)
def activation_error(activation: ActivationBlock, factor: int) -> float:
    """Largest error of an activation against tanh, over every code of its input."""
    fmt = activation.in_fmt
    codes = np.arange(fmt.low, fmt.high + 1)
    q = factor * activation.real_input(codes)
    miss = activation.real_result(activation.process(codes)) - np.tanh(q)
    return float(np.abs(miss).max())


class ExactNeuron(NamedTuple):
    """One neuron's sum, computed in integers of unlimited width and multiplied by a factor."""

    formats: WeightedSum
    weights: Sequence[int]
    bias: int
    factor: int = 1


ExactLayers = tuple[list[ExactNeuron], Sequence[ActivationBlock], list[ExactNeuron]]


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
    """The hidden neurons of a design of two layers, the activation of each, and the outputs."""
    raise NotImplementedError(f"{design.block}: its exact layers are not known")


@exact_layers.register
def _(design: Hybrid) -> ExactLayers:
    hidden, outputs = (
        [ExactNeuron(s, *row) for row in zip(s.weights, s.biases, s.row_factors, strict=True)]
        for s in (design.input_integral, design.output_integral)
    )
    return hidden, design.activations, outputs


@exact_layers.register
def _(design: Parallel) -> ExactLayers:
    hidden, outputs = (
        [ExactNeuron(n, n.weights, n.bias, n.factor or 1) for n in neurons]
        for neurons in (design.hidden_neurons, design.output_neurons)
    )
    return hidden, design.activations, outputs


@singledispatch
def exact(design: Design, frames: Codes) -> Codes:
    """Output codes, computed layer by layer in unlimited integers.

    Activations are computed by parts, not read from tables of results.
    """

    def results(neuron: ExactNeuron, words: Codes) -> Codes:
        found = [
            exact_sum(neuron.formats, neuron.weights, neuron.bias, row, neuron.factor)[1]
            for row in words.tolist()
        ]
        return np.array(found, dtype=np.int64)

    hidden, activations, outputs = exact_layers(design)
    pairs = zip(hidden, activations, strict=True)
    r = np.stack([activation.compute(results(one, frames)) for one, activation in pairs], axis=1)
    return np.stack([results(one, r) for one in outputs], axis=1)


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
    return [node.weights for node in exact_layers(design)[0]]


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
    design: Design, mlp: DenseNetwork, precision: Precision, sensors: int, met: Sequence[float] = ()
) -> Real:
    """How far each output can be from real arithmetic that saturates, in real units.

    mlp: The network of the design.
    sensors: How many inputs are samples; the others are outputs of earlier networks.
    met: Where the ranges of layers are from the data; see ``golden.engine.quantise.planned``.
    """
    assert mlp.plain
    fracs = precision.hidden_fmt.frac, SIGNAL.frac
    return two_layer_bounds(
        mlp,
        precision,
        exact_layers(design)[1],
        lambda n, real, codes: _rounded(real, codes, precision, fracs[n]),
    )


@error_bounds.register
def _(
    design: Engine,
    mlp: DenseNetwork,
    _precision: Precision,
    sensors: int,
    met: Sequence[float] = (),
) -> Real:
    return engine_bounds(mlp, design.program.segment_width, sensors, met)


@error_bounds.register
def _(
    design: AdderGraph,
    mlp: DenseNetwork,
    precision: Precision,
    _sensors: int,
    met: Sequence[float] = (),
) -> Real:
    if not mlp.plain:
        return layered_bounds(mlp, design.layers, design.activations, met)
    (activations,) = design.activations
    return two_layer_bounds(
        mlp, precision, activations, lambda n, real, codes: _off(real, codes, design.layers[n])
    )


def _off(real: Dense, layer: Layer, matrix: ConstantMatrix) -> Real:
    """How far each result can be from the real sum of samples of magnitude 1 at most.

    The error has three parts: the rounding of weights and bias; the bits that are dropped in the
    sum, with one unit more for the halves that its constant loses; and half a step of the result.
    """
    rounding = _coefficients_off(real, layer)
    units = np.array([max(map(abs, ends)) + 1 for ends in matrix.errors], dtype=np.float64)
    step = 2.0**-matrix.out_fmt.frac
    result: Real = rounding + (units / 2.0**matrix.out_shift + 0.5) * step
    return result
