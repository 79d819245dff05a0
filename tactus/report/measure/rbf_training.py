"""Trains a radial basis function network in two stages, as Netlab's rbftrain does.

The thesis names that routine (section 3.11.2). The first stage finds the centres: expectation
maximisation fits a mixture of round Gaussians to the inputs, starting from a few steps of k-means.
The second finds the outputs by linear least squares. I. T. Nabney, "NETLAB: Algorithms for Pattern
Recognition", Springer, 2002.
"""

import numpy as np
from scipy.cluster.vq import kmeans2
from scipy.special import softmax

from golden.input_error import InputError
from golden.networks.rbf import Rbf
from golden.numbers.real import Real

KMEANS_STEPS = 5
EM_STEPS = 100

# A Gaussian that has shrunk to one sample keeps this part of the variance of all inputs, so that
# its own is not 0. A variance in fixed units would spread each Gaussian over all rows of small
# inputs, and their centres would coincide.
LEAST_VARIANCE = 1e-6
# A Gaussian that has lost all but this part of a row stays where it is.
LEAST_WEIGHT = 1e-6


def squared_distances(points: Real, centres: Real) -> Real:
    """The squared distances between points and centres, shape (points, centres)."""
    result: Real = ((points[:, np.newaxis] - centres) ** 2).sum(axis=-1)
    return result


def mixture_centres(inputs: Real, count: int, rng: np.random.Generator) -> Real:
    """Centres of a mixture of ``count`` round Gaussians, shape (count, inputs).

    inputs: shape (rows, inputs).
    rng: Determines where k-means begins.
    """
    distinct = len(np.unique(inputs, axis=0))
    if not 1 <= count <= distinct:
        raise InputError(
            f"got {distinct} distinct rows for {count} centres, expected at least as many rows"
        )
    centres: Real = kmeans2(inputs, count, iter=KMEANS_STEPS, minit="++", seed=rng)[0]
    least = LEAST_VARIANCE * inputs.var(axis=0).mean()
    nearest = squared_distances(inputs, centres).min(axis=1)
    variances = np.full(count, nearest.mean() / inputs.shape[1] + least)
    shares = np.full(count, 1 / count)
    for _ in range(EM_STEPS):
        squares = squared_distances(inputs, centres) / variances
        logarithms = np.log(shares) - (squares + inputs.shape[1] * np.log(variances)) / 2
        belongs = softmax(logarithms, axis=1)
        weights = belongs.sum(axis=0) + np.finfo(np.float64).tiny
        shares = weights / weights.sum()
        alive = weights > LEAST_WEIGHT
        means = belongs.T @ inputs / weights[:, np.newaxis]
        centres = np.where(alive[:, np.newaxis], means, centres)
        spread = (belongs * squared_distances(inputs, centres)).sum(axis=0) / weights
        variances = np.maximum(spread / inputs.shape[1], least)
    return centres


def train_rbf(inputs: Real, targets: Real, hidden: int, rng: np.random.Generator) -> Rbf:
    """Train the network from one start.

    All widths are the largest distance between two centres, which is Netlab's default and gives
    wide functions that overlap. (The mixture's own widths suit the inputs and not the targets: on
    the recorded vectors they give ten times the error.)

    inputs: shape (rows, inputs).
    targets: shape (rows, outputs).
    hidden: 2 or more.
    """
    if hidden < 2:
        raise InputError(f"hidden: got {hidden}, expected 2 or more")
    centres = mixture_centres(inputs, hidden, rng)
    width = np.sqrt(squared_distances(centres, centres).max())
    outputs = targets.shape[1]
    empty = Rbf(centres, np.full(hidden, width), np.zeros((outputs, hidden)), np.zeros(outputs))
    design = np.concatenate([empty.hidden(inputs), np.ones((len(inputs), 1))], axis=1)
    solved: Real = np.linalg.lstsq(design, targets, rcond=None)[0]
    return Rbf(centres, empty.widths, solved[:-1].T, solved[-1])
