"""The function that training minimises for a network of learned functions."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from golden.real import Real
from golden.splines.network import SplineNetwork
from golden.splines.word_errors import WordErrors
from golden.training.objective import Rows


@dataclass(frozen=True)
class Penalty:
    """What a coefficient costs besides the errors.

    Attributes
    ----------
    bend : float
        Factor of the squared second differences of the coefficients of each function, which keeps
        functions smooth (P. H. C. Eilers and B. D. Marx, 1996).
    size : float
        Factor of the squared coefficients.
    """

    bend: float
    size: float = 1e-6


@dataclass(frozen=True)
class SplineObjective:
    """sum(((y - t) / scale)**2) + penalties, over the training rows.

    Where the words of hidden sums are not exact, the errors that come from them are added.

    Parameters
    ----------
    like : SplineNetwork
        A network with the splines that are trained.
    rows : Rows
    penalty : Penalty
    freedom : float array, shape (coefficients, parameters)
        The coefficients are ``freedom @ parameters``; see ``Edges.freedom``.
    word_error : float
        The error of the word of a hidden sum as a part of its range; see ``WordErrors``.
    """

    like: SplineNetwork
    rows: Rows
    penalty: Penalty
    freedom: Real
    word_error: float = 0.0

    @cached_property
    def _spread(self) -> Real:
        return self.like.spread(self.rows.inputs)

    @cached_property
    def _words(self) -> WordErrors:
        return WordErrors(self.word_error, self._spread, self.rows.scale)

    @cached_property
    def stiffness(self) -> Real:
        """The matrix P of the penalty ``p' P p`` of the parameters p."""
        whole = np.zeros((len(self.freedom),) * 2)
        at = 0
        for functions in (self.like.first, self.like.second):
            count = functions.shape[-1]
            bends = np.diff(np.eye(count), 2, axis=0)
            block = self.penalty.bend * bends.T @ bends + self.penalty.size * np.eye(count)
            for _ in range(functions.size // count):
                whole[at : at + count, at : at + count] = block
                at += count
        return np.asarray(self.freedom.T @ whole @ self.freedom)

    def network(self, parameters: Real) -> SplineNetwork:
        """The network with these parameters."""
        return self.like.unpacked(self.freedom @ parameters)

    def errors(self, parameters: Real) -> Real:
        """The scaled errors, shape (rows, outputs)."""
        network = self.network(parameters)
        values, _ = network.hidden.at(network.sums(self._spread))
        return self._scaled(network, values)

    def value(self, parameters: Real) -> float:
        """The function at a point."""
        found = float(
            (self.errors(parameters) ** 2).sum() + parameters @ self.stiffness @ parameters
        )
        if self.word_error:
            found += self._words.value(self.network(parameters))
        return found

    def jacobian(self, parameters: Real) -> tuple[Real, Real]:
        """The scaled errors as a vector, and their derivatives by the parameters."""
        network = self.network(parameters)
        values, slopes = network.hidden.at(network.sums(self._spread))
        errors = self._scaled(network, values)
        rows, outputs = errors.shape
        weight = 1 / self.rows.scale
        back = np.einsum("rhk,ohk,ro->roh", slopes, network.second, weight, optimize=True)
        first = back[..., np.newaxis] * self._spread[:, np.newaxis, np.newaxis, :]
        second = np.zeros((rows, outputs, outputs, values[0].size))
        for o in range(outputs):
            second[:, o, o] = values.reshape(rows, -1) * weight[:, o, np.newaxis]
        biases = weight[..., np.newaxis] * np.eye(outputs)
        parts = [part.reshape(rows * outputs, -1) for part in (first, second, biases)]
        return errors.ravel(), np.concatenate(parts, axis=1) @ self.freedom

    def around(self, parameters: Real) -> tuple[float, Real, Real]:
        """The function at a point, half its gradient, and half its Hessian by Gauss and Newton."""
        errors, jacobian = self.jacobian(parameters)
        pull = self.stiffness @ parameters
        value = float(errors @ errors + parameters @ pull)
        gradient, hessian = jacobian.T @ errors + pull, jacobian.T @ jacobian + self.stiffness
        if self.word_error:
            added, pushed, curved = self._words.around(self.network(parameters))
            value += added
            gradient += self.freedom.T @ pushed
            hessian += self.freedom.T @ curved @ self.freedom
        return value, gradient, hessian

    def _scaled(self, network: SplineNetwork, values: Real) -> Real:
        outputs = np.einsum("rhk,ohk->ro", values, network.second) + network.biases
        return np.asarray((outputs - self.rows.targets) / self.rows.scale)
