"""How far a bit-true network of two layers can be from real arithmetic."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from golden.activation.activation_block import ActivationBlock
from golden.engine.formats import ONE, coeff_frac
from golden.engine.quantise import first_values, planned
from golden.layers.constant_matrix import ConstantMatrix
from golden.networks.constants import Layer, quantised, used_nodes
from golden.numbers.precision import SIGNAL, Precision
from golden.numbers.real import Real
from golden.trained.dense import DenseNetwork
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


def layered_bounds(
    network: DenseNetwork,
    layers: Sequence[ConstantMatrix],
    activations: Sequence[Sequence[ActivationBlock]],
    met: Sequence[float] = (),
) -> Real:
    """The bounds of the error of each output of a network in matrices and tables.

    Layer by layer the error of a sum is that of its operands, times their weights, plus the error
    of the rounded weights and bias, of the bits that are cut, and of rounding the result. Behind a
    table its error is added. No activation has a slope above 1. A quantiser is exact where its
    operands are; where they are not, it can be a whole step off.

    The bounds hold for frames in which no sum saturates in front of a ReLU or a linear layer. With
    ``met``, the ranges of these layers are from the data; see ``planned``.
    """
    values = first_values(network.shape[0], 0)
    errors = np.zeros(len(values))
    tables = [*activations, ()]
    for one, matrix, table in zip(planned(network, values, met), layers, tables, strict=True):
        exact, layer = one.exact, one.layer
        weights = np.array(
            [[abs(float(row[v.node] * v.factor)) for v in values] for row in exact.weights]
        )
        off = weights @ errors
        if exact.grid:
            off = np.where(off > 0, off + 2.0 ** (exact.grid.cut - layer.result.frac), 0.0)
        else:
            reached = [max(-v.low, v.high) * 2.0**-v.fmt.frac for v in values]
            halves = [2.0 ** -(coeff_frac(layer.result, v.fmt) + 1) for v in values]
            off = off + np.dot(halves, reached) + 2.0 ** -(coeff_frac(layer.result, ONE) + 1)
            units = max(max(map(abs, ends)) for ends in matrix.errors) + 1
            step = 2.0**-matrix.out_fmt.frac
            off = off + (units / 2.0**matrix.out_shift + 0.5) * step
            off = off + max((activation_error(one, 1) for one in table), default=0.0)
            # The largest word is a step below 1.
            off = off + step * (exact.activation == "hard_tanh")
        values = one.values
        errors = off[[value.node for value in values]]
    result: Real = off
    return result


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
