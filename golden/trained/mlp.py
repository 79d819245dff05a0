"""The network in floating point, with which every bit-true network is compared."""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import ArrayLike

from golden.input_error import InputError
from golden.numbers.real import Real

# An activation returns its value and its slope, because training needs both.
Activation = Callable[[Real], tuple[Real, Real]]


def tanh(q: Real) -> tuple[Real, Real]:
    """The hyperbolic tangent and its slope."""
    value = np.tanh(q)
    return value, 1 - value * value


def shifted(biases: Real, weights: Real, shift: Real) -> Real:
    """Compute ``biases + weights @ shift``, where each sum is rounded only once.

    So the order of addition cannot change any bit of the hardware.

    biases: shape (neurons,).
    weights: shape (neurons, inputs).
    shift, shape (inputs,): Number that is added to each input.
    """
    terms = np.concatenate([biases[:, np.newaxis], weights * shift], axis=1)
    sums: Real = terms.sum(axis=1)
    if np.isfinite(terms).all():
        sums = np.array([float(sum(map(Fraction, row))) for row in terms.tolist()])
    return sums


@dataclass(frozen=True)
class Mlp:
    """y = w2 f(w1 x + b1) + b2 (thesis equation 3.11).

    w1: shape (hidden, inputs).
    b1: shape (hidden,).
    w2: shape (outputs, hidden).
    b2: shape (outputs,).
    """

    w1: Real
    b1: Real
    w2: Real
    b2: Real

    def __post_init__(self) -> None:
        shapes = [np.shape(a) for a in (self.w1, self.b1, self.w2, self.b2)]
        hidden, outputs = len(self.b1), len(self.b2)
        inputs = shapes[0][-1] if len(shapes[0]) == 2 else 0
        expected = [(hidden, inputs), (hidden,), (outputs, hidden), (outputs,)]
        if shapes != expected:
            raise InputError(
                f"w1, b1, w2, b2: got shapes {shapes}, expected (hidden, inputs), (hidden,), "
                "(outputs, hidden), (outputs,)"
            )
        for name in ("w1", "b1", "w2", "b2"):
            if not np.isfinite(getattr(self, name)).all():
                raise InputError(f"{name}: got NaN or infinity, expected finite numbers")

    @property
    def shape(self) -> tuple[int, int, int]:
        """The numbers of inputs, hidden nodes and outputs."""
        return self.w1.shape[1], self.w1.shape[0], self.w2.shape[0]

    def process(self, frames: ArrayLike, activation: Activation = tanh) -> Real:
        """Outputs, shape (..., outputs), for frames, shape (..., inputs)."""
        hidden, _ = activation(np.asarray(frames, dtype=np.float64) @ self.w1.T + self.b1)
        result: Real = hidden @ self.w2.T + self.b2
        return result
