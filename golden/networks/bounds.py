"""How far a bit-true network can be from real arithmetic."""

from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np

from golden.activation.activation_block import ActivationBlock
from golden.engine.formats import HIDDEN, ONE, RESULT, coeff_frac
from golden.engine.function_table import table_of
from golden.engine.grid import Value
from golden.engine.quantise import PlannedLayer, first_values, planned
from golden.layers.constant_matrix import ConstantMatrix
from golden.networks.constants import Layer, quantised, used_nodes
from golden.numbers.precision import SIGNAL, Precision
from golden.numbers.real import Real
from golden.trained.dense import DenseNetwork, Trained
from golden.trained.function import Function
from golden.trained.mlp import Mlp


def two_layer_bounds(
    mlp: Mlp, precision: Precision, activations: Sequence[ActivationBlock]
) -> Real:
    """The bound of the error of each output.

    Saturation increases no difference between two values, and tanh has no slope above 1. So the
    bound of y is the error of rounding in layer 2, plus ``|w2|`` times the error of r, which comes
    from the activation and from the rounding of q. The weights of a node that is not built are
    rounded to 0, so it is part of the error of rounding alone.
    """
    first = quantised(mlp.w1, mlp.b1, precision, "layer 1 weights")
    second = quantised(mlp.w2, mlp.b2, precision, "layer 2 weights")
    built = built_nodes(second, len(activations))
    q_off = _rounded(mlp.w1, mlp.b1, first, precision, precision.hidden_fmt.frac)
    r_off = q_off[built] + [
        activation_error(a, first.factors[j]) for a, j in zip(activations, built, strict=True)
    ]
    result: Real = _rounded(mlp.w2, mlp.b2, second, precision, SIGNAL.frac)
    return result + np.abs(mlp.w2[:, built]) @ r_off


def built_nodes(second: Layer, count: int) -> list[int]:
    """The hidden nodes of a design that has ``count`` of them; all, or those that are used."""
    every = list(range(len(second.weights[0])))
    return every if len(every) == count else used_nodes(second)


def engine_bounds(
    network: Trained, segment_width: int, sensors: int, met: Sequence[float] = ()
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
        exact, layer = one.exact, one.layer
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
        return off + step * (one.exact.activation == "hard_tanh")

    values = first_values(network.shape[0], 0)
    return _through(network, values, met, np.zeros(len(values)), add)


def _through(
    network: Trained,
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
        exact, result = one.exact, one.layer.result
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
        values = one.values
        errors = off[[value.node for value in values]]
    return off


@lru_cache
def _steepest(function: Function) -> float:
    """The largest slope of a function over the codes of q."""
    q = HIDDEN.to_real(np.arange(HIDDEN.low, HIDDEN.high + 1))
    return float(np.abs(np.diff(function.value(q))).max() * 2.0**HIDDEN.frac)


def _rounded(
    weights: Real, biases: Real, layer: Layer, precision: Precision, out_frac: int
) -> Real:
    """How far a layer's sums can be off for samples of magnitude 1 at most, shape (neurons,).

    The error has three parts: the rounding of weights and bias, one LSB for each product from which
    bits are dropped, and half an LSB of the result.
    """
    factors = np.asarray(layer.factors, dtype=np.float64)
    rounding = np.abs(weights - factors[:, np.newaxis] * layer.fmt.to_real(layer.weights))
    total = rounding.sum(axis=1) + np.abs(biases - factors * layer.fmt.to_real(layer.biases))
    acc_frac = SIGNAL.frac + layer.fmt.frac - precision.product_shift
    cut = weights.shape[1] * 2.0**-acc_frac if precision.product_shift else 0.0
    half = 2.0 ** -(out_frac + 1) if acc_frac > out_frac else 0.0
    result: Real = total + factors * (cut + half)
    return result


@lru_cache(maxsize=256)
def activation_error(activation: ActivationBlock, factor: int) -> float:
    """Largest error of an activation against tanh, over every code of its input."""
    fmt = activation.in_fmt
    codes = np.arange(fmt.low, fmt.high + 1)
    q = factor * activation.real_input(codes)
    miss = activation.real_result(activation.process(codes)) - np.tanh(q)
    return float(np.abs(miss).max())
