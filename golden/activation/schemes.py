"""The activations that a scene can name: how each computes in real arithmetic, how it is built."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from golden.activation.activation_block import ActivationBlock
from golden.activation.gradient import Gradient
from golden.activation.precise import Precise
from golden.activation.precise_table import FORMATS, curve_table
from golden.activation.segments import gradient_real, segment_table
from golden.networks.mlp import Activation, tanh
from golden.precision import PRECISE, SIGNAL, Precision


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


def precise_for(precision: Precision, factor: int, reach: int, *, coefficients: str) -> Precise:
    """tanh within one unit of 2**-13 for a neuron with magnitudes to ``reach``.

    Raises
    ------
    ValueError
        When the precision's q has another format than the one the segments are made for, or is
        normalised.
    """
    if precision.hidden_fmt != PRECISE.hidden_fmt or factor != 1:
        raise ValueError(
            f"activation precise: got q in {precision.hidden_fmt}, normalised by {factor}, of "
            f"precision {precision.name!r}, expected {PRECISE.hidden_fmt} as it is, of precision "
            f"{PRECISE.name!r}"
        )
    fmt = FORMATS[coefficients]
    most = len(curve_table(fmt).intercepts)
    words = min(min(reach, precision.hidden_fmt.high) // (1 << fmt.distance_width) + 1, most)
    return Precise(
        precision.hidden_fmt, SIGNAL, coefficients, words, variant=f"{coefficients}{words}"
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


SCHEMES = {
    "gradient": Scheme(gradient_real, gradient_for),
    "precise": Scheme(tanh, partial(precise_for, coefficients="logic")),
    "precise_block_ram": Scheme(tanh, partial(precise_for, coefficients="block_ram")),
}
