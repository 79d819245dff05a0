"""A bit-true network against real arithmetic that saturates, with a bound of the difference."""

import numpy as np

from golden.networks.constants import quantised
from golden.networks.design import Design
from golden.networks.oracle import error_bounds
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL, Precision
from golden.trained.mlp import Mlp


def real_error(
    mlp: Mlp, precision: Precision, network: Design, frames: Codes, found: Codes, sensors: int
) -> list[tuple[float, float]]:
    """The largest error over the frames, and its bound, for each output in units of 2**-13.

    The reference uses tanh and the unrounded weights. In it, q saturates to the range of its
    format, and y to that of the signals.

    network: The bit-true network.
    frames, found: The samples and the results.
    sensors: How many inputs are samples. The inputs after them are outputs of earlier networks.
    """
    factors = quantised(mlp.w1, mlp.b1, precision, "layer 1 weights").factors
    hidden = precision.hidden_fmt
    bounds = error_bounds(network, mlp, precision, sensors)
    ends = np.multiply.outer(hidden.to_real([hidden.low, hidden.high]), factors)
    q = np.clip(SIGNAL.to_real(frames) @ mlp.w1.T + mlp.b1, *ends)
    y = np.clip(np.tanh(q) @ mlp.w2.T + mlp.b2, *SIGNAL.to_real([SIGNAL.low, SIGNAL.high]))
    errors = np.abs(SIGNAL.to_real(found) - y).max(axis=0)
    return [
        (2**SIGNAL.frac * float(error), 2**SIGNAL.frac * float(bound))
        for error, bound in zip(errors, bounds, strict=True)
    ]
