"""The errors of networks on the generated recordings of the swing, for more and more noise."""

import numpy as np

from golden.numbers.real import Real
from golden.trained.mlp import Mlp, tanh
from tactus.physics.swing_data import ANGLES, NOISE, Coding, record
from tactus.report.measure.table import Cell, Table
from tactus.scene import thesis_table
from tactus.scene.metrics import displacement_errors
from tactus.train.descent.levenberg_marquardt import descend
from tactus.train.descent.objective import Objective, Rows, pack, unpack
from tactus.train.descent.search import starting_weights

FORMS = ("single", "multiple", "cascade")
HIDDEN = {"x": 7, "y": 7, "z": 9}  # the Multiple network of section 6.5
NOISES = (0.0, NOISE, 2 * NOISE)
STARTS, STEPS, PATIENCE, WEIGHT_DECAY = 3, 200, 40, 1e-4
EVERY = 10  # rows of the training run, and as many in between to validate


def _network(data: Real, column: int, hidden: int, rng: np.random.Generator) -> Mlp:
    """3:hidden:1, the best of a few starts on the validation rows."""
    training, validation = (
        Rows(rows[:, :3], rows[:, column : column + 1], np.ones((len(rows), 1)))
        for rows in (data[::EVERY], data[EVERY // 2 :: EVERY])
    )
    shape = (3, hidden, 1)
    found = []
    for _ in range(STARTS):
        objective = Objective(shape, tanh, training, validation, WEIGHT_DECAY, PATIENCE)
        best = unpack(objective.search(descend, pack(starting_weights(shape, rng)), STEPS), shape)
        found.append((float((validation.residuals(best, tanh) ** 2).sum()), best))
    return min(found, key=lambda pair: pair[0])[1]


def recordings(seed: int) -> Table:
    """Errors on an independent run, beside those of Table 6.2."""
    printed = thesis_table("swing")
    rows: list[list[Cell]] = []
    for noise in NOISES:
        train, test = (record(angle, seed + n, noise) for n, angle in enumerate(ANGLES[:2]))
        coding = Coding.of(train)
        learnt, held = coding.code(train), coding.code(test)
        rng = np.random.default_rng(seed)
        for c, (name, hidden) in enumerate(HIDDEN.items()):
            mlp = _network(learnt, 3 + c, hidden, rng)
            found = mlp.process(held[:, :3], tanh)
            (error,) = displacement_errors(found, held[:, [3 + c]])
            metres = error.mean / coding.scale[c]
            rows.append(
                [
                    1e6 * noise,
                    name,
                    1e3 * error.displacement / coding.scale[c],
                    1e3 * metres,
                    error.percent,
                    *(
                        printed[form]["percent_error"][c]
                        for form in ("single", "multiple", "cascade")
                    ),
                ]
            )
    return Table(
        "recordings",
        [
            "noise uV",
            "output",
            "end to end mm",
            "error mm",
            "error %",
            *(f"printed {form}" for form in FORMS),
        ],
        rows,
        "The figures are mean errors of networks 3:7:1, 3:7:1 and 3:9:1 in floating point, in "
        "percent of the mean distance from end to end, beside the percentages of Table 6.2. The "
        f"networks are the best of {STARTS} starts. They are trained on every {EVERY}th sample of "
        f"a release from {ANGLES[0]:g} degrees and measured on a release from {ANGLES[1]:g} "
        "degrees. The noise is at each sensor, before the gain.",
    )
