"""What words of the hidden sums that are not exact add to the errors of a network."""

from dataclasses import dataclass

import numpy as np

from golden.numbers.real import Real
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
        """The sum over all rows, outputs and hidden sums."""
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
