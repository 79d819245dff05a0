"""The activations that a scene can name: how each computes in real arithmetic, how it is built."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from golden.activation.activation_block import ActivationBlock
from golden.activation.gradient import Gradient
from golden.activation.segments import gradient_real, segment_table
from golden.networks.mlp import Activation
from golden.precision import SIGNAL, Precision


def gradient_for(precision: Precision, factor: int, reach: int) -> Gradient:
    """The Gradient activation for a neuron normalised by ``factor`` with magnitudes to ``reach``.

    Raises
    ------
    ValueError
        When the factor is too large for the formats; see ``segments.segment_table``.
    """
    table = segment_table(
        factor,
        reach,
        precision.hidden_fmt,
        SIGNAL,
        precision.coeff_width,
        precision.gradient_frac_limit,
        precision.intercept_frac,
        precision.rounding,
    )
    return Gradient(
        precision.hidden_fmt,
        SIGNAL,
        table,
        precision.intercept_frac,
        precision.intercept_frac,
        precision.rounding,
        variant=f"q{factor}c{len(table.thresholds)}",
    )


@dataclass(frozen=True)
class Scheme:
    """One activation by name.

    Attributes
    ----------
    real : callable
        Value and slope in floating point; training descends on it.
    build : callable
        The bit-true block for a precision, a neuron's Q, and the largest magnitude code that the
        neuron can produce.
    """

    real: Activation
    build: Callable[[Precision, int, int], ActivationBlock]


SCHEMES = {"gradient": Scheme(gradient_real, gradient_for)}
