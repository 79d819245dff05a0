"""The function that training minimises for a network of learned functions, and its descent."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from golden.numbers.real import Real
from tactus.train.objective import Rows, curvature_roots, entropies, probabilities
from tactus.train.splines.network import SplineNetwork


@dataclass(frozen=True)
class WordErrors:
    """The expected squared errors of the outputs that come from inexact words of the hidden sums.

    In first order, the error of a word becomes that of an output times the slope of the function
    between them. Errors of different words are independent, so the squares are added up.

    part: The root mean square of the error of a word, as a part of the range that its sum has on
        the rows.
    spread, shape (rows, inputs * splines): The splines of the inputs of the rows.
    scale, shape (rows, outputs): By what errors of the outputs are divided.
    """

    part: float
    spread: Real
    scale: Real

    def value(self, network: SplineNetwork) -> float:
        sums = network.sums(self.spread)
        steep = self._weighted(network, network.hidden.at(sums)[1])
        return float(((steep * np.ptp(sums, axis=0)) ** 2).sum())

    def value_gradient_hessian(self, network: SplineNetwork) -> tuple[Real, Real]:
        """Half the gradient of the value, and half its Hessian by Gauss and Newton.

        The derivatives are those by all coefficients and biases, in the order of ``packed``.
        """
        sums = network.sums(self.spread)
        _, slopes = network.hidden.at(sums)
        ranges = np.ptp(sums, axis=0)
        ends = self.spread[sums.argmax(axis=0)] - self.spread[sums.argmin(axis=0)]
        steep = self._weighted(network, slopes)
        bent = self._weighted(network, network.hidden.bends(sums)) * ranges
        places = np.arange(len(network.packed()))
        first = places[: network.first.size].reshape(len(ranges), -1)
        second = places[network.first.size :][: network.second.size].reshape(network.second.shape)
        gradient, hessian = np.zeros(len(places)), np.zeros((len(places),) * 2)
        # A function of a hidden sum has to do with few coefficients.
        for o, h in np.ndindex(second.shape[:2]):
            errors = steep[:, o, h] * ranges[h]
            by_first = bent[:, o, h, np.newaxis] * self.spread + np.outer(steep[:, o, h], ends[h])
            by_second = slopes[:, h] * (self.part * ranges[h] / self.scale[:, o, np.newaxis])
            jacobian = np.concatenate([by_first, by_second], axis=1)
            own = np.concatenate([first[h], second[o, h]])
            gradient[own] += jacobian.T @ errors
            hessian[np.ix_(own, own)] += jacobian.T @ jacobian
        return gradient, hessian

    def _weighted(self, network: SplineNetwork, splines: Real) -> Real:
        """Derivatives of the functions of the sums, shape (rows, outputs, hidden)."""
        weight = self.part / self.scale
        found = np.einsum("rhk,ohk,ro->roh", splines, network.second, weight, optimize=True)
        return np.asarray(found)


# Below this a probability counts as this, so that it has an inverse.
LEAST_PROBABILITY = 1e-300


class Squares:
    """The squares of the scaled errors: ``sum(((y - t) / scale)**2)``."""

    def errors(self, outputs: Real, rows: Rows) -> Real:
        """The numbers whose squares add up to the loss, some for each row."""
        return np.asarray((outputs - rows.targets) / rows.scale)

    def value_gradient_hessian(self, outputs: Real, rows: Rows) -> tuple[Real, Real]:
        """Misses m and roots R of each row, shapes (rows, n) and (rows, n, outputs).

        By the outputs, half the gradient of the loss is R' m, and half its curvature is R' R.
        """
        weight = 1 / rows.scale
        return self.errors(outputs, rows), weight[..., np.newaxis] * np.eye(weight.shape[1])


class CrossEntropy(Squares):
    """The cross-entropy of outputs that are logits, with one-hot targets.

    Its curvature by the logits is carried to the parameters by their first derivatives alone (the
    generalised Gauss-Newton matrix), as for MLPs in ``tactus.train.objective``.
    """

    def errors(self, outputs: Real, rows: Rows) -> Real:
        return np.sqrt(entropies(outputs, rows.targets))[:, np.newaxis]

    def value_gradient_hessian(self, outputs: Real, rows: Rows) -> tuple[Real, Real]:
        # The gradient is S m with m = (p - t) / sqrt(p), since sqrt(p)' m is 0.
        parts = np.maximum(probabilities(outputs), LEAST_PROBABILITY)
        misses = (parts - rows.targets) / np.sqrt(parts)
        return misses / np.sqrt(2), curvature_roots(parts) / np.sqrt(2)


@dataclass(frozen=True)
class SplineObjective:
    """The loss of the outputs on the training rows, and penalties.

    Where the words of hidden sums are not exact, the errors that come from them are added.

    like: A network with the splines that are trained.
    bend: Factor of the squared second differences of the coefficients of each function, which keeps
        functions smooth (P. H. C. Eilers and B. D. Marx, 1996).
    size: Factor of the squared coefficients.
    freedom, shape (coefficients, parameters): The coefficients are ``freedom @ parameters``; see
        ``Edges.freedom``.
    word_error: The error of the word of a hidden sum as a part of its range; see ``WordErrors``.
    """

    like: SplineNetwork
    rows: Rows
    bend: float
    size: float
    freedom: Real
    loss: Squares
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
            block = self.bend * bends.T @ bends + self.size * np.eye(count)
            for _ in range(functions.size // count):
                whole[at : at + count, at : at + count] = block
                at += count
        return np.asarray(self.freedom.T @ whole @ self.freedom)

    def network(self, parameters: Real) -> SplineNetwork:
        return self.like.unpacked(self.freedom @ parameters)

    def errors(self, parameters: Real) -> Real:
        """The numbers whose squares add up to the loss; see ``Squares.errors``."""
        network = self.network(parameters)
        values, _ = network.hidden.at(network.sums(self._spread))
        return self.loss.errors(_outputs(network, values), self.rows)

    def value(self, parameters: Real) -> float:
        found = float(
            (self.errors(parameters) ** 2).sum() + parameters @ self.stiffness @ parameters
        )
        if self.word_error:
            found += self._words.value(self.network(parameters))
        return found

    @cached_property
    def _places(self) -> list[NDArray[np.int64]]:
        """Of each hidden sum the parameters that it depends on; of each output its own.

        Those of an output are the parameters of the functions that it adds up, and its constant.
        """
        first, second = self.like.first, self.like.second
        sums, outputs = len(first), len(second)
        shapes = [first[0].size] * sums + [second[0].size] * outputs
        ends = np.cumsum(shapes)
        found = []
        for n, (end, size) in enumerate(zip(ends, shapes, strict=True)):
            own = np.flatnonzero(np.any(self.freedom[end - size : end], axis=0))
            constant = len(self.freedom.T) - outputs + n - sums
            found.append(own if n < sums else np.append(own, constant))
        return found

    @cached_property
    def _inputs(self) -> list[Real]:
        """The derivatives of each hidden sum by its parameters, on every row."""
        parts = np.split(self.freedom[: self.like.first.size], len(self.like.first))
        return [self._spread @ part[:, own] for part, own in zip(parts, self._places, strict=False)]

    def value_gradient_hessian(self, parameters: Real) -> tuple[float, Real, Real]:
        """The function at a point, half its gradient, and half its Hessian by Gauss and Newton.

        The gradient of the loss is J' m, and its Hessian J' J, where m are the misses, and J has
        the derivatives of the outputs by the parameters, times the roots of the loss. In a
        row, each column of J is the derivative of a hidden sum, or of an output, by a parameter of
        its own, times a factor for each miss. So J' J is made of blocks.
        """
        network = self.network(parameters)
        values, slopes = network.hidden.at(network.sums(self._spread))
        misses, roots = self.loss.value_gradient_hessian(_outputs(network, values), self.rows)
        through = np.einsum("rhk,ohk->roh", slopes, network.second, optimize=True)
        factors = np.concatenate([roots @ through, roots], axis=2)
        pulls = np.einsum("rqn,rq->rn", factors, misses)
        matrices = [*self._inputs, *self._values(values)]
        gradient, hessian = self.stiffness @ parameters, self.stiffness.copy()
        for n, (own, matrix) in enumerate(zip(self._places, matrices, strict=True)):
            gradient[own] += matrix.T @ pulls[:, n]
            weights = np.einsum("rq,rqn->rn", factors[:, :, n], factors[:, :, : n + 1])
            for k, (other, also) in enumerate(zip(self._places[: n + 1], matrices, strict=False)):
                block = matrix.T @ (weights[:, k, np.newaxis] * also)
                hessian[np.ix_(own, other)] += block
                if k < n:
                    hessian[np.ix_(other, own)] += block.T
        if self.word_error:
            pushed, curved = self._words.value_gradient_hessian(self.network(parameters))
            gradient += self.freedom.T @ pushed
            hessian += self.freedom.T @ curved @ self.freedom
        return self.value(parameters), gradient, hessian

    def _values(self, values: Real) -> Iterator[Real]:
        """The derivatives of each output by its parameters, on every row."""
        start, flat = self.like.first.size, values.reshape(len(values), -1)
        for own in self._places[len(self.like.first) :]:
            end = start + flat.shape[1]
            mine = flat @ self.freedom[start:end, own[:-1]]
            yield np.append(mine, np.ones((len(flat), 1)), axis=1)
            start = end


def _outputs(network: SplineNetwork, values: Real) -> Real:
    return np.asarray(np.einsum("rhk,ohk->ro", values, network.second) + network.biases)


# The damping as a part of the diagonal: at the start, its least, and that at which no step helps.
DAMPING, LEAST, MOST = 1e-3, 1e-12, 1e8
UP, DOWN = 4.0, 5.0
# A descent ends when a step gains less than this part of the function.
SETTLED = 1e-5
ROUNDING = 1e-12


def stopped_early(
    objective: SplineObjective, start: Real, steps: int, validation: SplineObjective, patience: int
) -> Real:
    """The point of a descent that has the least error on the rows of ``validation``.

    After ``patience`` points without a new best one the descent ends.
    """
    best, least, in_vain = start, np.inf, 0

    def seen(point: Real) -> bool:
        nonlocal best, least, in_vain
        error = float((validation.errors(point) ** 2).sum())
        if error < least:
            best, least, in_vain = point, error, 0
        else:
            in_vain += 1
        return in_vain >= patience

    descend(objective, start, steps, seen)
    return best


def descend(
    objective: SplineObjective,
    start: Real,
    steps: int,
    over: Callable[[Real], bool] = lambda point: False,
) -> Real:
    """The point that at most ``steps`` evaluations reach from ``start``, until it is ``over``."""
    point, damping = start, DAMPING
    value, gradient, hessian = objective.value_gradient_hessian(point)
    for _ in range(steps):
        scale = hessian.diagonal()
        held = hessian + np.diag(damping * scale + ROUNDING * scale.max())
        moved = point - np.linalg.solve(held, gradient)
        new = objective.value(moved)
        if not new < value:
            damping *= UP
            if damping > MOST:
                break
            continue
        settled = value - new < SETTLED * value
        point, damping = moved, max(damping / DOWN, LEAST)
        if over(point) or settled:
            break
        value, gradient, hessian = objective.value_gradient_hessian(point)
    return point
