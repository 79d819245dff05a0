"""The cross-entropy of outputs that are logits, and its derivatives by them.

The probability of a class is its part of the sum of exp(output) over all classes (softmax). The
cross-entropy of a row is the negative logarithm of the probability of its own class.
"""

import numpy as np

from golden.numbers.real import Real


def probabilities(logits: Real) -> Real:
    """The probability of each class for each row, shape (rows, classes)."""
    parts = np.exp(logits - logits.max(axis=1, keepdims=True))
    return parts / parts.sum(axis=1, keepdims=True)


def entropies(logits: Real, targets: Real) -> Real:
    """The cross-entropy of each row with one-hot targets, shape (rows,)."""
    own = (logits * targets).sum(axis=1, keepdims=True)
    # One term of the sum is exp(0), so that no result is below 0.
    return np.logaddexp.reduce(logits - own, axis=1)


def curvature_roots(parts: Real) -> Real:
    """Roots of the second derivatives by the logits, shape (rows, classes, classes).

    With the probabilities p of a row, these are diag(p) - p p' = S S', with
    S = diag(sqrt p) - p sqrt(p)'. The result is S' of each row.
    """
    roots = np.sqrt(parts)[:, np.newaxis, :]
    return np.eye(parts.shape[1]) * roots - np.swapaxes(roots, 1, 2) * parts[:, np.newaxis, :]
