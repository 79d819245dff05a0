"""The function that training minimises for a network of learned functions."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from golden.numbers.real import Real
from tactus.train.objective import Watched
from tactus.train.splines.network import SplineNetwork


@dataclass
class SplineObjective(Watched):
    """The loss of the outputs on the training rows, and penalties.

    Where the words of hidden sums are not exact, the expected squared errors of the outputs that
    come from them are added. In first order, the error of a word becomes that of an output times
    the slope of the function between them. Errors of different words are independent, so the
    squares are added up.

    bend: Factor of the squared second differences of the coefficients of each function, which keeps
        functions smooth (P. H. C. Eilers and B. D. Marx, 1996).
    size: Factor of the squared coefficients.
    freedom, shape (coefficients, parameters): The coefficients are ``freedom @ parameters``; see
        ``Edges.freedom``.
    word_error: The root mean square of the error of the word of a hidden sum, as a part of the
        range that the sum has on the rows.
    """

    bend: float
    size: float
    freedom: Real
    word_error: float = 0.0
    # See ``normal_equations``.
    settled = 1e-5

    @cached_property
    def _spread(self) -> Real:
        return self.like.spread(self.training.inputs)

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
        network: SplineNetwork = self.like.unpacked(self.freedom @ parameters)
        return network

    def outputs(self, vector: Real, inputs: Real) -> Real:
        return self.network(vector).process(inputs)

    def value(self, parameters: Real) -> float:
        network = self.network(parameters)
        sums = network.sums(self._spread)
        errors = self.training.errors(network.from_sums(sums))
        found = float((errors**2).sum() + parameters @ self.stiffness @ parameters)
        if self.word_error:
            steep = self._by_words(network, network.hidden.at(sums)[1])
            found += float(((steep * np.ptp(sums, axis=0)) ** 2).sum())
        self.note(found, parameters)
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

    def gradient_hessian(self, parameters: Real) -> tuple[Real, Real]:
        """Half the gradient of the function, and half its Hessian by Gauss and Newton.

        The Hessian of the loss is J' J, where J has the derivatives of the outputs by the
        parameters, times the roots of the loss. In a row, each column of J is the derivative of a
        hidden sum, or of an output, by a parameter of its own, times a factor for each root. So J'
        J is made of blocks.
        """
        network = self.network(parameters)
        sums = network.sums(self._spread)
        values, slopes = network.hidden.at(sums)
        outputs = network.from_sums(sums)
        through = np.einsum("rhk,ohk->roh", slopes, network.second, optimize=True)
        roots, pulls = self.training.roots(outputs), self.training.slopes(outputs)
        factors = np.concatenate([roots @ through, roots], axis=2)
        pulls = np.concatenate([np.einsum("ro,roh->rh", pulls, through), pulls], axis=1)
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
            pushed, curved = self._word_errors(network, sums, slopes)
            gradient += self.freedom.T @ pushed
            hessian += self.freedom.T @ curved @ self.freedom
        return gradient, hessian

    def _word_errors(self, network: SplineNetwork, sums: Real, slopes: Real) -> tuple[Real, Real]:
        """Half the gradient of what errors of words add, and half its Hessian.

        The derivatives are those by all coefficients and biases, in the order of ``packed``.
        """
        ranges = np.ptp(sums, axis=0)
        ends = self._spread[sums.argmax(axis=0)] - self._spread[sums.argmin(axis=0)]
        steep = self._by_words(network, slopes)
        bent = self._by_words(network, network.hidden.bends(sums)) * ranges
        places = np.arange(len(network.packed()))
        first = places[: network.first.size].reshape(len(ranges), -1)
        second = places[network.first.size :][: network.second.size].reshape(network.second.shape)
        gradient, hessian = np.zeros(len(places)), np.zeros((len(places),) * 2)
        # A function of a hidden sum has to do with few coefficients.
        for o, h in np.ndindex(second.shape[:2]):
            errors = steep[:, o, h] * ranges[h]
            by_first = bent[:, o, h, np.newaxis] * self._spread + np.outer(steep[:, o, h], ends[h])
            scale = self.training.scale[:, o, np.newaxis]
            by_second = slopes[:, h] * (self.word_error * ranges[h] / scale)
            jacobian = np.concatenate([by_first, by_second], axis=1)
            own = np.concatenate([first[h], second[o, h]])
            gradient[own] += jacobian.T @ errors
            hessian[np.ix_(own, own)] += jacobian.T @ jacobian
        return gradient, hessian

    def _by_words(self, network: SplineNetwork, splines: Real) -> Real:
        """Derivatives of scaled outputs by words, shape (rows, outputs, hidden)."""
        weight = self.word_error / self.training.scale
        return np.asarray(
            np.einsum("rhk,ohk,ro->roh", splines, network.second, weight, optimize=True)
        )

    def _values(self, values: Real) -> Iterator[Real]:
        """The derivatives of each output by its parameters, on every row."""
        start, flat = self.like.first.size, values.reshape(len(values), -1)
        for own in self._places[len(self.like.first) :]:
            end = start + flat.shape[1]
            mine = flat @ self.freedom[start:end, own[:-1]]
            yield np.append(mine, np.ones((len(flat), 1)), axis=1)
            start = end
