"""The function that training minimises for a network of learned functions."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from golden.real import Real
from golden.splines.loss import Loss
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
    """The loss of the outputs on the training rows, and penalties.

    Where the words of hidden sums are not exact, the errors that come from them are added.

    Parameters
    ----------
    like : SplineNetwork
        A network with the splines that are trained.
    rows : Rows
    penalty : Penalty
    freedom : float array, shape (coefficients, parameters)
        The coefficients are ``freedom @ parameters``; see ``Edges.freedom``.
    loss : Loss
    word_error : float
        The error of the word of a hidden sum as a part of its range; see ``WordErrors``.
    """

    like: SplineNetwork
    rows: Rows
    penalty: Penalty
    freedom: Real
    loss: Loss
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
        """The numbers whose squares add up to the loss; see ``Loss.errors``."""
        network = self.network(parameters)
        values, _ = network.hidden.at(network.sums(self._spread))
        return self.loss.errors(_outputs(network, values), self.rows)

    def value(self, parameters: Real) -> float:
        """The function at a point."""
        found = float(
            (self.errors(parameters) ** 2).sum() + parameters @ self.stiffness @ parameters
        )
        if self.word_error:
            found += self._words.value(self.network(parameters))
        return found

    def jacobian(self, parameters: Real) -> tuple[Real, Real]:
        """The misses m as a vector, and J: the loss has half the gradient J' m, and J' J.

        J has the derivatives of the outputs by the parameters, times the roots of ``Loss.around``.
        """
        network = self.network(parameters)
        values, slopes = network.hidden.at(network.sums(self._spread))
        misses, roots = self.loss.around(_outputs(network, values), self.rows)
        through = np.einsum("rhk,ohk->roh", slopes, network.second, optimize=True)
        back = np.einsum("rqo,roh->rqh", roots, through)
        first = back[..., np.newaxis] * self._spread[:, np.newaxis, np.newaxis, :]
        second = roots[..., np.newaxis] * values.reshape(len(values), 1, 1, -1)
        parts = [part.reshape(misses.size, -1) for part in (first, second, roots)]
        return misses.ravel(), np.concatenate(parts, axis=1) @ self.freedom

    def around(self, parameters: Real) -> tuple[float, Real, Real]:
        """The function at a point, half its gradient, and half its Hessian by Gauss and Newton."""
        misses, jacobian = self.jacobian(parameters)
        pull = self.stiffness @ parameters
        gradient, hessian = jacobian.T @ misses + pull, jacobian.T @ jacobian + self.stiffness
        if self.word_error:
            pushed, curved = self._words.around(self.network(parameters))
            gradient += self.freedom.T @ pushed
            hessian += self.freedom.T @ curved @ self.freedom
        return self.value(parameters), gradient, hessian


def _outputs(network: SplineNetwork, values: Real) -> Real:
    return np.asarray(np.einsum("rhk,ohk->ro", values, network.second) + network.biases)
