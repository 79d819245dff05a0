"""The search over hidden nodes and restarts, and the choice of the network.

Each candidate runs three steps: the optimiser on tanh; the same on the activation that the hardware
has, so that the weights make up for its error; and a shift of the output biases by the mean
bit-true error, which takes out what truncation adds. The candidate with the least bit-true error
on the validation rows is kept. A candidate depends on the scene, its hidden nodes and its number
alone, so neither the number of workers nor an interruption changes the outcome.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray

from golden.metrics import error_scale, percent_errors
from golden.networks.mlp import Mlp, tanh
from golden.precision import SIGNAL
from golden.scene import Scene, Vectors
from golden.training import levenberg_marquardt, scg
from golden.training.objective import Objective, Rows, pack, unpack

OPTIMISERS = {"levenberg-marquardt": levenberg_marquardt.descend, "scg": scg.descend}


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
class Result:
    """What became of one candidate.

    Attributes
    ----------
    hidden, restart : int
        Which candidate.
    validation, test : float
        Root mean square of the bit-true percent errors; infinite where it was refused.
    refused : str
        Why the hardware's formats cannot hold it, or nothing.
    """

    hidden: int
    restart: int
    validation: float
    test: float
    refused: str = ""

    @property
    def rank(self) -> tuple[float, int, int]:
        """Less is better; equal errors go to the smaller network, then the earlier restart."""
        return self.validation, self.hidden, self.restart


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
    weight = 1 / error_scale(vectors.targets, scene.outputs, scene.full_scale)[rows] ** 2
    for _ in range(2):
        results = SIGNAL.to_real(scene.build(mlp).process(vectors.codes[rows]))
        miss = (weight * (vectors.targets[rows] - results)).sum(axis=0) / weight.sum(axis=0)
        mlp = Mlp(mlp.w1, mlp.b1, mlp.w2, mlp.b2 + miss)
    return mlp


def train(scene: Scene, vectors: Vectors, hidden: int, restart: int) -> Mlp:
    """The network of one candidate.

    Raises
    ------
    ValueError
        When the hardware's formats cannot hold its weights.
    """
    settings = scene.training
    split = split_rows(len(vectors.inputs), settings.seed)
    # Trained on what the hardware sees: the quantised samples.
    inputs = SIGNAL.to_real(vectors.codes)
    scale = error_scale(vectors.targets, scene.outputs, scene.full_scale)
    training, validation = (
        Rows(inputs[rows], vectors.targets[rows], scale[rows])
        for rows in (split.training, split.validation)
    )
    shape = (len(scene.sensors), hidden, len(scene.outputs))
    rng = np.random.default_rng([settings.seed, hidden, restart])
    point = pack(starting_weights(shape, rng))
    descend = OPTIMISERS[settings.optimiser]
    for activation in (tanh, scene.scheme.real):
        objective = Objective(shape, activation, training, validation, settings.weight_decay)
        descend(objective, point, settings.steps)
        if objective.best is not None:
            point = objective.best
    return shift_biases(scene, unpack(point, shape), vectors, split.training)


def measure(scene: Scene, vectors: Vectors, hidden: int, restart: int) -> Result:
    """Train one candidate and measure its bit-true errors."""
    try:
        mlp = train(scene, vectors, hidden, restart)
        results = SIGNAL.to_real(scene.build(mlp).process(vectors.codes))
    except ValueError as error:
        return Result(hidden, restart, float("inf"), float("inf"), str(error))
    split = split_rows(len(vectors.inputs), scene.training.seed)
    errors = percent_errors(results, vectors.targets, scene.outputs, scene.full_scale)
    validation, test = (
        float(np.sqrt((errors[rows] ** 2).mean())) for rows in (split.validation, split.test)
    )
    return Result(hidden, restart, validation, test)


def candidates(scene: Scene) -> list[tuple[int, int]]:
    """Hidden nodes and restart of every candidate, the smallest networks first."""
    low, high = scene.training.hidden
    if scene.hidden:
        low = high = scene.hidden
    return [(h, r) for h in range(low, high + 1) for r in range(scene.training.restarts)]


def search(scene: Scene, vectors: Vectors, record: Path, workers: int = -1) -> Iterator[Result]:
    """Every candidate's result, in order, as it becomes known.

    Parameters
    ----------
    scene : Scene
    vectors : Vectors
    record : Path
        Results are appended to this file; those it already holds are not computed again.
    workers : int
        Processes; -1 for one a core. The outcome does not depend on it. joblib runs them, so a
        cluster can be named with ``joblib.parallel_config``.

    Raises
    ------
    ValueError
        For too few rows to split.
    """
    split_rows(len(vectors.inputs), scene.training.seed)
    known = {(r.hidden, r.restart): r for r in _read(record)}
    missing = [c for c in candidates(scene) if c not in known]
    # The recorded ones stand first in the order, except after a crash between two lines.
    yield from (known[c] for c in candidates(scene) if c in known)
    jobs = (delayed(measure)(scene, vectors, hidden, restart) for hidden, restart in missing)
    record.parent.mkdir(parents=True, exist_ok=True)
    with record.open("a") as handle:
        for result in Parallel(n_jobs=workers, return_as="generator")(jobs):
            handle.write(json.dumps(asdict(result)) + "\n")
            handle.flush()
            yield result


def _read(record: Path) -> Iterator[Result]:
    """Results of an earlier, interrupted search; a last line cut off by it is dropped."""
    if not record.is_file():
        return
    lines = record.read_text().split("\n")
    for line in lines[:-1]:
        yield Result(**json.loads(line))
    if lines[-1]:
        record.write_text("\n".join(lines[:-1]) + "\n")
