"""The training and the validation error during training, as in Figure 3.12 of the thesis."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from golden.numbers.real import Real
from tactus.report.measure.table import Cell, Table
from tactus.scene import load_scene
from tactus.scene.disturbance import Disturbance
from tactus.train.descent.objective import Objective, unpack
from tactus.train.descent.search import train
from tactus.train.descent.task import task_for

# The network that the thesis shows, and one with more nodes for the same rows and more.
SCENES = ("digit-parallel", "digit-single")
EVALUATIONS = 20_000
# The numbers of evaluations at which errors are noted: four for each factor of two.
LOOKS = frozenset(round(2 ** (n / 4)) for n in range(60))

NOTES = {
    "convergence": "The figures are root mean square errors in percent (equation 3.16) during one "
    "training by scaled conjugate gradients, in floating point with tanh and without early "
    "stopping. Half of the rows train and a quarter validates. Each row shows the point with the "
    "least training error up to that number of evaluations. The network 2:6:2 is trained on the 57 "
    "rows of the narrow loads, and 4:16:4 on all 143 rows.",
}


@dataclass
class Followed(Objective):
    """An objective that notes both errors of the best point on the training rows so far.

    notes: The number of evaluations, and the rms errors of training and of validation rows in
        percent.
    """

    evaluations: int = 0
    notes: list[tuple[int, float, float]] = field(default_factory=list)
    _both: tuple[float, float] = (np.inf, np.inf)

    def residuals(self, vector: Real) -> Real:
        before = self._lowest
        result = super().residuals(vector)
        self.evaluations += 1
        if self._lowest < before:
            mlp = unpack(vector, self.shape)
            self._both = (
                _percent(self.training.residuals(mlp, self.activation)),
                _percent(self.validation.residuals(mlp, self.activation)),
            )
        if self.evaluations in LOOKS:
            self.notes.append((self.evaluations, *self._both))
        return result


def _percent(residuals: Real) -> float:
    return float(100 * np.sqrt((residuals**2).mean()))


def convergence(seed: int) -> Table:
    """The errors during training by the optimiser of the thesis; the seed sets split and starts."""
    rows: list[list[Cell]] = []
    for name in SCENES:
        scene = load_scene(name)
        # Training is not stopped early, because the figure is about the errors after the best
        # point.
        settings = replace(
            scene.training,
            seed=seed,
            optimiser="scg",
            steps=EVALUATIONS // 2,
            patience=EVALUATIONS,
            weight_decay=0.0,
            split="random",
            split_by=(),
            disturbance=Disturbance(),
        )
        scene = replace(scene, training=settings)
        task = task_for(scene, scene.vectors(), [])
        descents: list[Followed] = []

        def objective(*args: Any, into: list[Followed] = descents) -> Followed:
            into.append(Followed(*args))
            return into[-1]

        train(task, scene.members[0].hidden, 0, objective)
        # The first descent uses tanh, and the second the activation of the hardware.
        rows += [[scene.describe(), *note] for note in descents[0].notes]
    return Table(
        "convergence",
        ["network", "evaluations", "training %", "validation %"],
        rows,
        NOTES["convergence"],
    )
