"""Validation error against processor time, for two optimisers and two ways to train a cascade."""

import time
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

from golden.numbers.real import Real
from golden.trained.mlp import Mlp
from tactus.report.measure.table import Cell, Table
from tactus.scene import Scene, load_scene
from tactus.scene.disturbance import Disturbance
from tactus.train.descent.objective import Descend, Objective, unpack
from tactus.train.descent.search import bit_true_errors, train
from tactus.train.descent.task import Task, task_for

RESTARTS = 3
# A step of each optimiser takes a different time. So many steps take a few seconds.
STEPS = {"levenberg-marquardt": 300, "scg": 4000}
# The numbers of evaluations at which a descent is noted: about three for each factor of two.
LOOKS = frozenset(round(2 ** (n / 2)) for n in range(30))

CASCADE_RESTARTS = 6
CASCADES = {"cascade A": "float", "cascade B": "bit-true"}


@dataclass
class Watched(Objective):
    """An objective that notes how far its descent has come.

    notes: The evaluations of the residuals, the seconds of processor time, and the best point so
        far.
    """

    evaluations: int = 0
    notes: list[tuple[int, float, Real]] = field(default_factory=list)
    started: float = field(default_factory=time.process_time)

    def residuals(self, vector: Real) -> Real:
        result = super().residuals(vector)
        self.evaluations += 1
        if self.evaluations in LOOKS:
            self.note()
        return result

    def search(self, descend: Descend, start: Real, steps: int) -> Real:
        found = super().search(descend, start, steps)
        if not self.notes or self.notes[-1][0] < self.evaluations:
            self.note()
        return found

    def note(self) -> None:
        if self.best is not None:
            point = self.best.copy()
            self.notes.append((self.evaluations, time.process_time() - self.started, point))


def _configured(name: str, seed: int, **settings: Any) -> Scene:
    scene = load_scene(name)
    return replace(scene, training=replace(scene.training, seed=seed, **settings))


def _watched(task: Task, hidden: int, restart: int) -> tuple[Mlp, list[Watched]]:
    """A trained network, and the objective of each of its descents."""
    descents: list[Watched] = []

    def objective(*args: Any) -> Watched:
        descents.append(Watched(*args))
        return descents[-1]

    return train(task, hidden, restart, objective), descents


def _optimisers(seed: int) -> Iterator[list[Cell]]:
    """The errors of the 4:16:4 network of digit-single during training, from the same starts."""
    for optimiser, steps in STEPS.items():
        # Training is not stopped early. The best point on the validation rows is kept in any case.
        scene = _configured(
            "digit-single",
            seed,
            optimiser=optimiser,
            steps=steps,
            patience=10 * steps,
            weight_decay=1e-6,
            split="random",
            split_by=(),
            disturbance=Disturbance(),
        )
        task = task_for(scene, scene.vectors(), [])
        hidden = scene.members[0].hidden
        for restart in range(RESTARTS):
            _, (objective,) = _watched(task, hidden, restart)
            for evaluations, seconds, point in objective.notes:
                errors = bit_true_errors(task, unpack(point, objective.shape))
                yield [optimiser, "all", restart, evaluations, seconds, *errors]


def _cascades(seed: int) -> Iterator[list[Cell]]:
    """The candidates of each network of thesis-larger. The best one feeds the next network."""
    for method, earlier in CASCADES.items():
        scene = _configured("comparison/thesis-larger", seed, earlier_outputs=earlier)
        vectors = scene.vectors()
        chosen: list[Mlp] = []
        for member, shape in zip(scene.members, (mlp.shape for mlp in scene.mlps()), strict=True):
            task = task_for(scene, vectors, chosen)
            found: list[tuple[float, Mlp]] = []
            for restart in range(CASCADE_RESTARTS):
                started = time.process_time()
                mlp, descents = _watched(task, shape[1], restart)
                seconds = time.process_time() - started
                validation, test = bit_true_errors(task, mlp)
                found.append((validation, mlp))
                count = sum(objective.evaluations for objective in descents)
                yield [method, member.outputs[0], restart, count, seconds, validation, test]
            chosen.append(min(found, key=lambda pair: pair[0])[1])


def training(seed: int) -> Table:
    """Both optimisers on one network, then both cascades; the seed sets split and starts."""
    return Table(
        "training",
        ["method", "output", "restart", "evaluations", "CPU s", "validation %", "test %"],
        [*_optimisers(seed), *_cascades(seed)],
        "The figures are root mean squares of the bit-true percent errors, on the quarter of the "
        "rows that chose the network and on a quarter that took no part. The optimisers train the "
        "4:16:4 network of digit-single from the same starts on the same rows. Each of their rows "
        "is the best point up to that number of evaluations of the training error. Cascade A "
        "trains each network of thesis-larger on the floating-point outputs of the networks before "
        "it, and cascade B on the bit-true ones. Each of their rows is one start; the best start "
        "is used for the next network. 'CPU s' is the processor time since the start began. A "
        "difference in a last bit can lead a descent to another minimum, so the errors are those "
        "of this machine and its version of SciPy.",
        timed=["CPU s"],
    )
