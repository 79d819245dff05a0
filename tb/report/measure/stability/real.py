"""A bit-true network against real arithmetic that saturates, and how far apart they can be."""

from __future__ import annotations

import numpy as np

from golden.fixed import Codes
from golden.mlp import Mlp
from golden.networks.constants import quantised
from golden.networks.design import Design
from golden.networks.oracle import error_bounds
from golden.precision import SIGNAL, Precision


def real_error(
    mlp: Mlp, precision: Precision, network: Design, frames: Codes, found: Codes, sensors: int
) -> list[tuple[float, float]]:
    """Error and bound of each output, in units of 2**-13, the largest over the frames.

    Compared with tanh and the unrounded weights; q saturates to the range of its format, y to that
    of the signals.

    Parameters
    ----------
    mlp : Mlp
    precision : Precision
    network : Design
        Bit-true, with every hidden node of ``mlp``.
    frames, found : int64 arrays
        Samples and results.
    sensors : int
        Inputs that are samples; those behind them are outputs of earlier networks.
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
