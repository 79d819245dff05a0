"""The two precisions, which define how real weights become a bit-true network.

``thesis`` normalises every neuron by Q_j and every output by Y_i (equations 4.16 and 4.17), and
uses 14 bits everywhere. ``exact`` keeps the weights unchanged in 18 bits, computes exactly, and
rounds once per layer.
"""

from dataclasses import dataclass

import numpy as np

from golden.input_error import InputError
from golden.numbers.fixed import Codes, Fix, Rounding
from golden.numbers.real import Real

SIGNAL = Fix(14, 13)  # what ADC and DAC carry

# MyHDL's conversion is wrong for numbers from here on.
FACTOR_LIMIT = 1 << 30


@dataclass(frozen=True)
class Precision:
    """Formats and policies of one precision.

    normalise: Whether to divide weights by Q_j and Y_i, and to multiply the outputs by Y_i again.
    coeff_width: Number of signed bits of a weight, a bias or a gradient.
    coeff_frac: Fraction bits of weights and biases; with None, the most with which the layer fits.
    product_shift: Number of fraction bits that are dropped from each product before it is added.
    hidden_fmt: Format of q, the input of the activation.
    gradient_frac_limit, intercept_frac: Formats of the Gradient scheme's constants.
    rounding: How the gradient activation drops its last bits.
    activation: The activation of a scene that names none.
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
    activation: str

    def coefficients(self, weights: Real, biases: Real, layer: str) -> tuple[Codes, Codes, Fix]:
        """Codes of a layer's weights and biases and the format they share.

        A weight that normalises to exactly 1, which does not fit in Fix(14,13), saturates. This is
        an error of one LSB, no more than the rounding of two other weights.
        """
        if self.coeff_frac is None:
            both = np.concatenate([weights.ravel(), biases.ravel()])
            fmt = Fix.largest_frac(self.coeff_width, both, layer)
        else:
            fmt = Fix(self.coeff_width, self.coeff_frac)
        return fmt.quantise(weights, layer)[0], fmt.quantise(biases, layer)[0], fmt


def normalisation(weights: Real, biases: Real, layer: str = "weights") -> Codes:
    """Q_j or Y_i: the sum of the magnitudes of a neuron's weights and bias, each rounded up.

    Equations 4.16 and 4.17. A neuron whose weights are all zero gets 1.

    weights: shape (neurons, inputs).
    biases: shape (neurons,).
    layer: Name of the weights in an error message.
    """
    # All summands are whole numbers, so below 2**53 the sum is exact in any order.
    with np.errstate(over="ignore"):
        total = np.ceil(np.abs(weights)).sum(axis=1) + np.ceil(np.abs(biases))
    if total.max() >= FACTOR_LIMIT:
        raise InputError(
            f"{layer}: got magnitudes that add up to {total.max():g}, expected below {FACTOR_LIMIT}"
        )
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
    activation="gradient",
)
EXACT = Precision(
    name="exact",
    normalise=False,
    coeff_width=18,
    coeff_frac=None,
    product_shift=0,
    hidden_fmt=Fix(18, 14),
    gradient_frac_limit=17,
    intercept_frac=17,
    rounding=Rounding.ROUND,
    activation="precise",
)
PRECISIONS = {p.name: p for p in (THESIS, EXACT)}
