"""The errors of networks of learned functions beside those of MLPs, on the same held-out rows.

Both are trained on the same disturbed rows, from as many starts, and chosen by the same validation
rows. Both are measured in floating point, on samples as the converter codes them.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Protocol

import numpy as np

from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from golden.trained.dense import packed, unpacked
from golden.trained.mlp import Mlp, tanh
from tactus.report.measure.table import Cell
from tactus.scene import load_scene
from tactus.train.objective import Objective, Rows, levenberg_marquardt
from tactus.train.search import starting_weights
from tactus.train.splines import search as splines
from tactus.train.splines.search import Learned, SplineSettings
from tactus.train.task import task_for

SCENE = load_scene("digit")
# The networks of each arrangement, by the outputs that each of them has.
ARRANGEMENTS = {
    "single": ((0, 1, 2, 3),),
    "multiple": ((0,), (1,), (2,), (3,)),
    "cascade": ((0,), (1,), (2,), (3,)),
}
CANDIDATES = {"cascade": 30, "multiple": 30, "single": 10}
SPLITS = (1, 2, 3)
# Intervals of an input and of a hidden sum, and the penalties, of candidates that are splines.
INTERVALS, STRAIGHT, BENDS = ((2, 4), (4, 4)), ((0, 4),), (0.01, 0.03, 0.1)
# The settings of an MLP as in the shipped scenes.
STEPS_MLP, PATIENCE, DECAY = 300, 40, 1e-6


class Model(Protocol):
    """A trained network of either kind."""

    def process(self, frames: Real) -> Real:
        """Outputs, shape (frames, outputs)."""


@dataclass(frozen=True)
class Kind:
    """A kind of network: how its candidates are trained, and how one is trained further."""

    name: str
    candidates: Sequence[object]
    train: Callable[..., Model]
    refit: Callable[..., Model]
    prune: Callable[..., Model] = field(default=lambda model, training, validation: model)


def train_mlp(hidden: int, rng: np.random.Generator, training: Rows, validation: Rows) -> Mlp:
    shape = (training.inputs.shape[1], hidden, training.targets.shape[1])
    return descended(starting_weights(shape, rng), training, validation)


def descended(mlp: Mlp, training: Rows, validation: Rows) -> Mlp:
    aim = Objective(mlp, tanh, training, validation, DECAY, PATIENCE)
    return unpacked(aim.search(levenberg_marquardt, packed(mlp), STEPS_MLP), mlp)


def pruned(model: Learned, training: Rows, validation: Rows) -> Learned:
    return splines.pruned(model, training, validation, rms)


def mlps(name: str, hidden: Sequence[int]) -> Kind:
    return Kind(f"MLP, {name} nodes", hidden, train_mlp, lambda m, rows: descended(m, rows, rows))


def learned(nodes: int, prune: bool = False, straight: bool = False) -> Kind:
    """Networks of learned functions with so many hidden sums, or of functions of weighted sums."""
    what = "functions of weighted sums" if straight else "functions"
    intervals = STRAIGHT if straight else INTERVALS
    settings = [SplineSettings(nodes, *pair, bend) for pair in intervals for bend in BENDS]
    kind = Kind(f"{what}, {nodes} nodes", settings, splines.trained, splines.refitted)
    return replace(kind, name=f"{kind.name}, pruned", prune=pruned) if prune else kind


KINDS = {
    "single": (mlps("16", (16,)), learned(4, True), learned(6, straight=True)),
    "multiple": (mlps("4 to 8", range(4, 9)), learned(3, True), learned(3, straight=True)),
    "cascade": (
        mlps("4 to 8", range(4, 9)),
        learned(2),
        *(learned(nodes, prune) for nodes in (3, 4) for prune in (False, True)),
        *(learned(nodes, straight=True) for nodes in (3, 4, 5)),
    ),
}


@cache
def parts(split: int) -> tuple[dict[str, Rows], Rows]:
    """The rows that train and choose, as the scene's own training makes them; those held out."""
    vectors = SCENE.vectors()
    task = task_for(replace(SCENE, training=replace(SCENE.training, seed=split)), vectors, [])
    places = {
        "training": task.split.training,
        "validation": task.split.validation,
        "known": np.concatenate([task.split.training, task.split.validation]),
    }
    found = {}
    for name, rows in places.items():
        inputs = getattr(task, name).inputs
        many = np.tile(rows, len(inputs) // len(rows))
        found[name] = Rows(inputs, vectors.targets[many], vectors.scale[many])
    test = task.split.test
    inputs = SIGNAL.to_real(SCENE.codes_of(vectors.inputs[test]))
    return found, Rows(inputs, vectors.targets[test], vectors.scale[test])


def percent(outputs: Real, rows: Rows) -> Real:
    return np.asarray(100 * (outputs - rows.targets) / rows.scale)


def rms(model: Model, rows: Rows) -> float:
    return float(np.sqrt((percent(model.process(rows.inputs), rows) ** 2).mean()))


def outputs_of(arrangement: str, models: Sequence[Model], samples: Real) -> tuple[Real, Real]:
    """The outputs of networks, and what the next one sees; in a cascade those before."""
    seen, outputs = samples, samples[:, :0]
    for model in models:
        outputs = np.hstack([outputs, model.process(seen)])
        if arrangement == "cascade":
            seen = np.hstack([samples, outputs])
    return outputs, seen


def held_out(arrangement: str, kind: Kind, split: int) -> Real:
    """The mean error of each output on the rows that neither trained nor chose, in percent."""
    given, test = parts(split)
    chosen: list[Model] = []
    tested: list[Model] = []
    for number, outputs in enumerate(ARRANGEMENTS[arrangement]):

        def rows(models: list[Model], part: str, at: Sequence[int] = outputs) -> Rows:
            whole = given[part]
            seen = outputs_of(arrangement, models, whole.inputs)[1]
            return Rows(seen, whole.targets[:, list(at)], whole.scale[:, list(at)])

        training, validation = (rows(chosen, part) for part in ("training", "validation"))
        candidates = [
            kind.train(
                kind.candidates[n % len(kind.candidates)],
                np.random.default_rng([split, number, n]),
                training,
                validation,
            )
            for n in range(CANDIDATES[arrangement])
        ]
        best = min(candidates, key=lambda model: rms(model, validation))
        chosen.append(kind.prune(best, training, validation))
        tested.append(kind.refit(chosen[-1], rows(tested, "known")))
    found = outputs_of(arrangement, tested, test.inputs)[0]
    return np.asarray(np.abs(percent(found, test)).mean(axis=0))


def rows() -> Iterator[dict[str, Cell]]:
    """The errors of each network on each split."""
    for arrangement, kinds in KINDS.items():
        for kind in kinds:
            for split in SPLITS:
                means = held_out(arrangement, kind, split)
                errors = {
                    f"{o} %": round(float(e), 4) for o, e in zip(SCENE.outputs, means, strict=True)
                }
                yield {"arrangement": arrangement, "network": kind.name, "split": split, **errors}
