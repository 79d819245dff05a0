"""How far a bit-true network of two layers can be from real arithmetic."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from golden.activation.activation_block import ActivationBlock
from golden.mlp import Mlp
from golden.networks.constants import Layer, quantised
from golden.precision import SIGNAL, Precision
from golden.real import Real


def two_layer_bounds(
    mlp: Mlp, precision: Precision, activations: Sequence[ActivationBlock]
) -> Real:
    """The bound of the error of each output.

    Saturation increases no difference between two values, and tanh has no slope above 1. So the
    bound of y is the error of rounding in layer 2, plus ``|w2|`` times the error of r, which comes
    from the activation and from the rounding of q.
    """
    first = quantised(mlp.w1, mlp.b1, precision, "layer 1 weights")
    second = quantised(mlp.w2, mlp.b2, precision, "layer 2 weights")
    q_off = _rounded(mlp.w1, mlp.b1, first, precision, precision.hidden_fmt.frac)
    r_off = q_off + [
        activation_error(a, q) for a, q in zip(activations, first.factors, strict=True)
    ]
    result: Real = _rounded(mlp.w2, mlp.b2, second, precision, SIGNAL.frac)
    return result + np.abs(mlp.w2) @ r_off


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
