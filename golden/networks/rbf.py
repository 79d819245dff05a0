"""The radial basis function network in floating point, with which the thesis compares its MLP."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.input_error import InputError
from golden.numbers.real import Real


@dataclass(frozen=True)
class Rbf:
    """``y = w phi(x) + b, phi_j = exp(-|x - c_j|^2 / (2 sigma_j^2))`` (equations 3.13, 3.14).

    centres, shape (hidden, inputs): The centres c_j.
    widths, shape (hidden,): The widths sigma_j, above 0, in the unit of the inputs.
    weights: shape (outputs, hidden).
    biases: shape (outputs,).
    """

    centres: Real
    widths: Real
    weights: Real
    biases: Real

    def __post_init__(self) -> None:
        names = ("centres", "widths", "weights", "biases")
        shapes = [np.shape(getattr(self, name)) for name in names]
        hidden, outputs = len(self.widths), len(self.biases)
        inputs = shapes[0][-1] if len(shapes[0]) == 2 else 0
        if shapes != [(hidden, inputs), (hidden,), (outputs, hidden), (outputs,)]:
            raise InputError(
                f"{', '.join(names)}: got shapes {shapes}, expected (hidden, inputs), (hidden,), "
                "(outputs, hidden), (outputs,)"
            )
        for name in names:
            if not np.isfinite(getattr(self, name)).all():
                raise InputError(f"{name}: got NaN or infinity, expected finite numbers")
        if not (self.widths > 0).all():
            raise InputError(f"widths: got {self.widths.min():g}, expected above 0")

    @property
    def shape(self) -> tuple[int, int, int]:
        """Inputs, hidden nodes and outputs."""
        return self.centres.shape[1], self.centres.shape[0], self.weights.shape[0]

    def hidden(self, frames: ArrayLike) -> Real:
        """Values of the basis functions, shape (..., hidden), for frames, shape (..., inputs)."""
        x = np.asarray(frames, dtype=np.float64)[..., np.newaxis, :]
        distance: Real = ((x - self.centres) ** 2).sum(axis=-1)
        result: Real = np.exp(-distance / (2 * self.widths**2))
        return result

    def process(self, frames: ArrayLike) -> Real:
        """Outputs, shape (..., outputs), for frames, shape (..., inputs)."""
        result: Real = self.hidden(frames) @ self.weights.T + self.biases
        return result
