"""The two precisions: how real weights become a bit-true network.

``thesis`` normalises every neuron by Q_j and every output by Y_i (equations 4.16 and 4.17) and
keeps 14 bits throughout. ``precise`` keeps the weights as they are in 18 bits, computes exactly
and rounds once a layer.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from golden.activation.gradient import Gradient
from golden.activation.segments import segment_table
from golden.fixed import Codes, Fix, Rounding
from golden.layers.input_integral import InputIntegral
from golden.layers.input_node import InputNode
from golden.layers.output_integral import OutputIntegral
from golden.networks.hybrid import Hybrid
from golden.networks.mlp import Mlp, Real

SIGNAL = Fix(14, 13)  # what ADC and DAC carry


@dataclass(frozen=True)
class Precision:
    """Formats and policies of one precision.

    Parameters
    ----------
    name : str
    normalise : bool
        Divide weights by Q_j and Y_i, and multiply the outputs by Y_i again.
    coeff_width : int
        Signed bits of a weight, a bias or a gradient.
    coeff_frac : int, or None
        Fraction bits of weights and biases; None takes the largest that fits the layer.
    product_shift : int
        Fraction bits cut from each product before it is added.
    hidden_fmt : Fix
        Format of q, the activation's input.
    gradient_frac_limit, intercept_frac : int
        Formats of the Gradient scheme's constants.
    rounding : Rounding
        How the activation ends.
    """

    name: str
    normalise: bool
    coeff_width: int
    coeff_frac: int | None
    product_shift: int
    hidden_fmt: Fix
    gradient_frac_limit: int
    intercept_frac: int
    rounding: Rounding

    def coefficients(self, weights: Real, biases: Real, layer: str) -> tuple[Codes, Codes, Fix]:
        """Codes of a layer's weights and biases and the format they share.

        A weight that normalises to exactly 1, which Fix(14,13) cannot hold, saturates: an error of
        one LSB, no more than the rounding of two other weights.
        """
        if self.coeff_frac is None:
            both = np.concatenate([weights.ravel(), biases.ravel()])
            fmt = Fix.largest_frac(self.coeff_width, both, layer)
        else:
            fmt = Fix(self.coeff_width, self.coeff_frac)
        return fmt.quantise(weights, layer)[0], fmt.quantise(biases, layer)[0], fmt


def normalisation(weights: Real, biases: Real) -> Codes:
    """Q_j or Y_i: the sum of the magnitudes of a neuron's weights and bias, each rounded up.

    Equations 4.16 and 4.17. A neuron whose weights are all zero gets 1.

    Parameters
    ----------
    weights : float array, shape (neurons, inputs)
    biases : float array, shape (neurons,)
    """
    total = np.ceil(np.abs(weights)).sum(axis=1) + np.ceil(np.abs(biases))
    return np.asarray(np.maximum(total, 1), dtype=np.int64)


THESIS = Precision(
    name="thesis",
    normalise=True,
    coeff_width=14,
    coeff_frac=13,
    product_shift=13,
    hidden_fmt=SIGNAL,
    gradient_frac_limit=13,
    intercept_frac=13,
    rounding=Rounding.TRUNCATE,
)
PRECISE = Precision(
    name="precise",
    normalise=False,
    coeff_width=18,
    coeff_frac=None,
    product_shift=0,
    hidden_fmt=Fix(18, 14),
    gradient_frac_limit=17,
    intercept_frac=17,
    rounding=Rounding.ROUND,
)
PRECISIONS = {p.name: p for p in (THESIS, PRECISE)}


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


def build_hybrid(mlp: Mlp, precision: Precision) -> Hybrid:
    """The bit-true folded network of ``mlp``.

    Raises
    ------
    ValueError
        When weights do not fit their format, or when in ``thesis`` precision a normalised sum
        could leave its 14 bits: the thesis' adders wrap, and a wrapped sum is a wrong sum.
    """
    _, hidden, outputs = mlp.shape
    ones = np.ones(hidden, dtype=np.int64), np.ones(outputs, dtype=np.int64)
    q_factors, y_factors = (
        (normalisation(mlp.w1, mlp.b1), normalisation(mlp.w2, mlp.b2))
        if precision.normalise
        else ones
    )
    w1, b1, fmt1 = precision.coefficients(
        mlp.w1 / q_factors[:, np.newaxis], mlp.b1 / q_factors, "layer 1 weights"
    )
    w2, b2, fmt2 = precision.coefficients(
        mlp.w2 / y_factors[:, np.newaxis], mlp.b2 / y_factors, "layer 2 weights"
    )
    nodes = tuple(
        InputNode(
            tuple(int(w) for w in w1[j]),
            int(b1[j]),
            SIGNAL,
            fmt1,
            precision.hidden_fmt,
            precision.product_shift,
            variant=str(j),
        )
        for j in range(hidden)
    )
    output = OutputIntegral(
        tuple(tuple(int(w) for w in row) for row in w2),
        tuple(int(b) for b in b2),
        tuple(int(y) for y in y_factors) if precision.normalise else None,
        SIGNAL,
        fmt2,
        SIGNAL,
        precision.product_shift,
    )
    if precision.normalise:
        for name, width in [(f"hidden node {j}", n.acc_width) for j, n in enumerate(nodes)] + [
            ("output layer", output.acc_width)
        ]:
            if width > SIGNAL.width:
                raise ValueError(
                    f"{name}: its normalised sum needs {width} bits and would wrap in "
                    f"{SIGNAL.width}; weights that are nearly whole numbers do this, retrain or "
                    "use the precise precision"
                )
    activations = tuple(
        gradient_for(precision, int(q), node.reach)
        for q, node in zip(q_factors, nodes, strict=True)
    )
    return Hybrid(InputIntegral(nodes), activations, output)
