"""Restarts, and the choice of the network by its bit-true error on rows it has not seen.

Each restart runs three steps: Levenberg-Marquardt on tanh; the same on the activation that the
hardware has, so that the weights make up for its error; and a shift of the output biases by the
mean bit-true error, which takes out what truncation adds. The restart with the least bit-true
error on the validation rows is kept.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from golden.activation.schemes import SCHEMES
from golden.metrics import percent_errors
from golden.networks.mlp import Mlp, Real, tanh
from golden.precision import SIGNAL
from golden.scene import Scene, Vectors
from golden.training.levenberg_marquardt import fit


@dataclass(frozen=True)
class Split:
    """Row numbers of the training, validation and test rows: 50, 25 and 25 % of all."""

    training: NDArray[np.int64]
    validation: NDArray[np.int64]
    test: NDArray[np.int64]


def split_rows(rows: int, seed: int) -> Split:
    """A random split of ``rows`` rows.

    Raises
    ------
    ValueError
        For fewer than 8 rows: a part would hold a single row or none.
    """
    if rows < 8:
        raise ValueError(f"got {rows} rows, expected at least 8 to split into 50, 25 and 25 %")
    order = np.random.default_rng(seed).permutation(rows)
    half, three_quarters = rows // 2, rows // 2 + rows // 4
    return Split(order[:half], order[half:three_quarters], order[three_quarters:])


@dataclass(frozen=True)
class Candidate:
    """One restart: the network and the root mean square of its bit-true percent errors."""

    restart: int
    mlp: Mlp
    validation_error: float
    test_error: float


def error_scale(scene: Scene, targets: Real) -> Real:
    """What each error counts against: the full scale of its output, or the target."""
    scale = np.abs(targets)
    for c, name in enumerate(scene.outputs):
        if name in scene.full_scale:
            scale[:, c] = scene.full_scale[name]
    return scale


def starting_weights(shape: tuple[int, int, int], rng: np.random.Generator) -> Mlp:
    """Random weights that leave every hidden node in its bend."""
    inputs, hidden, outputs = shape
    return Mlp(
        rng.normal(0, 0.7, (hidden, inputs)),
        rng.normal(0, 0.7, hidden),
        rng.normal(0, 0.2, (outputs, hidden)),
        rng.normal(0, 0.2, outputs),
    )


def shift_biases(scene: Scene, mlp: Mlp, vectors: Vectors, rows: NDArray[np.int64]) -> Mlp:
    """Output biases moved by the weighted mean bit-true error on ``rows``, twice."""
    weight = 1 / error_scale(scene, vectors.targets)[rows] ** 2
    for _ in range(2):
        results = SIGNAL.to_real(scene.build(mlp).process(vectors.codes[rows]))
        miss = (weight * (vectors.targets[rows] - results)).sum(axis=0) / weight.sum(axis=0)
        mlp = Mlp(mlp.w1, mlp.b1, mlp.w2, mlp.b2 + miss)
    return mlp


def run_restart(scene: Scene, vectors: Vectors, restart: int) -> Candidate:
    """One restart of the search; it depends on the scene's seed and its own number alone."""
    settings = scene.training
    rows = split_rows(len(vectors.inputs), settings.seed)
    # Trained on what the hardware sees: the quantised samples.
    inputs = SIGNAL.to_real(vectors.codes)[rows.training]
    targets = vectors.targets[rows.training]
    scale = error_scale(scene, targets)
    mlp = starting_weights(scene.shape, np.random.default_rng([settings.seed, restart]))
    for activation in (tanh, SCHEMES[scene.activation].real):
        mlp = fit(mlp, inputs, targets, scale, activation, settings.weight_decay, settings.steps)
    mlp = shift_biases(scene, mlp, vectors, rows.training)
    results = SIGNAL.to_real(scene.build(mlp).process(vectors.codes))
    errors = percent_errors(results, vectors.targets, scene.outputs, scene.full_scale)
    validation, test = (
        float(np.sqrt((errors[part] ** 2).mean())) for part in (rows.validation, rows.test)
    )
    return Candidate(restart, mlp, validation, test)
