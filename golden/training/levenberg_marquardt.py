"""Levenberg-Marquardt: weighted least squares over all weights at once, through SciPy."""

from __future__ import annotations

import numpy as np
from scipy.optimize import least_squares

from golden.networks.mlp import Activation, Mlp, Real


def pack(mlp: Mlp) -> Real:
    """All weights and biases in one vector: w1, b1, w2, b2, row by row."""
    return np.concatenate([mlp.w1.ravel(), mlp.b1, mlp.w2.ravel(), mlp.b2])


def unpack(vector: Real, shape: tuple[int, int, int]) -> Mlp:
    """The inverse of ``pack`` for a network of ``shape`` (inputs, hidden, outputs)."""
    inputs, hidden, outputs = shape
    sizes = np.cumsum([hidden * inputs, hidden, outputs * hidden])
    w1, b1, w2, b2 = np.split(vector, sizes)
    return Mlp(w1.reshape(hidden, inputs), b1, w2.reshape(outputs, hidden), b2)


def fit(
    start: Mlp,
    inputs: Real,
    targets: Real,
    scale: Real,
    activation: Activation,
    weight_decay: float,
    steps: int,
) -> Mlp:
    """The network that minimises sum((y - t) / scale)**2 + weight_decay * sum(w**2).

    Parameters
    ----------
    start : Mlp
        Where the descent begins.
    inputs : float array, shape (rows, inputs)
    targets, scale : float arrays, shape (rows, outputs)
        ``scale`` is what the error counts against: the target or a full scale.
    activation : callable
        Value and slope of the hidden layer's activation.
    weight_decay : float
        Keeps weights, and with them Q_j and Y_i, small.
    steps : int
        Most evaluations of the network.
    """
    shape = start.shape
    n_inputs, hidden, outputs = shape
    decay = float(np.sqrt(weight_decay))
    first_layer = hidden * n_inputs + hidden

    def residuals(vector: Real) -> Real:
        errors = (unpack(vector, shape).process(inputs, activation) - targets) / scale
        return np.concatenate([errors.ravel(), decay * vector])

    def jacobian(vector: Real) -> Real:
        mlp = unpack(vector, shape)
        r, slope = activation(inputs @ mlp.w1.T + mlp.b1)
        back = mlp.w2 * slope[:, np.newaxis, :]
        result = np.zeros((len(inputs), outputs, len(vector)))
        result[:, :, : hidden * n_inputs] = (
            back[..., np.newaxis] * inputs[:, np.newaxis, np.newaxis, :]
        ).reshape(len(inputs), outputs, -1)
        result[:, :, hidden * n_inputs : first_layer] = back
        for i in range(outputs):
            at = first_layer + i * hidden
            result[:, i, at : at + hidden] = r
            result[:, i, first_layer + outputs * hidden + i] = 1
        result /= scale[:, :, np.newaxis]
        return np.concatenate([result.reshape(-1, len(vector)), decay * np.eye(len(vector))])

    found = least_squares(residuals, pack(start), jacobian, method="lm", max_nfev=steps)
    return unpack(found.x, shape)
