"""The errors of networks on unseen rows, and the cost of training them for noise."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from golden.numbers.real import Real
from golden.trained.mlp import Mlp
from tactus.report.measure.table import Cell, Table
from tactus.scene import Scene, Vectors, load_scene
from tactus.scene.disturbance import Disturbance
from tactus.train.descent.search import measure, signed_errors
from tactus.train.descent.stages import Stages
from tactus.train.descent.task import task_for

SCENE = "digit"
# A search has hundreds of candidates, so shipped networks are at least as good as these.
RESTARTS = 3
HIDDEN = 10
FOLDS = 2
# How often noise is drawn for each row that is measured.
DRAWS = 10

# All loads have different weights, so a weight identifies a load.
SPLITS: dict[str, dict[str, Any]] = {
    "rows": {"split": "random", "split_by": ()},
    "placements": {"split": "blocks", "split_by": ("load",)},
    "loads": {"split": "groups", "split_by": ("load",)},
}
# Noise in volts: that for which networks are trained, unless a table says otherwise, and that with
# which every error is measured, besides the error as recorded.
TRAINED_FOR = 0.0005
EXPECTED = 0.002
NOISES = (0.0, 0.0005, 0.001, 0.002)

NOTES = {
    "honest": f"The figures are mean bit-true errors of networks like those of {SCENE}, on a "
    "quarter of the rows that neither trained nor chose them. This quarter consists of random "
    "rows, of blocks of neighbouring placements, or of all rows of some loads. Each figure is the "
    f"mean over {FOLDS} splits. Each network has {HIDDEN} hidden nodes and was trained for noise "
    f"of {1e3 * TRAINED_FOR:g} mV. It is the best of {RESTARTS} starts on the validation rows, and "
    "was then trained further with these rows too; a search for a shipped scene has hundreds of "
    f"starts. The last column has noise of {1e3 * EXPECTED:g} mV on every reading.",
    "robustness": f"The figures are mean bit-true errors of networks like those of {SCENE}, each "
    "trained for the noise in the first column. Two columns are of networks that were trained "
    "further with all rows, and are measured on all rows. The columns 'held out' are of networks "
    "that were trained without a quarter of the blocks of placements, and are measured on these "
    f"blocks. A column with {1e3 * EXPECTED:g} mV has so much noise on every reading. Each network "
    f"has {HIDDEN} hidden nodes and is the best of {RESTARTS} starts.",
}


def configured(seed: int, noise: float, settings: Mapping[str, Any]) -> Scene:
    """The scene with this split, which is trained for noise and trained on after the search."""
    scene, disturbance = load_scene(SCENE), Disturbance(noise=noise)
    own = replace(scene.training, seed=seed, refit=True, disturbance=disturbance, **settings)
    return replace(scene, training=own)


def trained(scene: Scene) -> Stages:
    """The trained networks, each the best of a few starts."""
    stages = Stages(scene)
    for number in range(len(scene.members)):
        task = stages.task(stages.chosen, number)
        found = [measure(task, HIDDEN, restart) for restart in range(RESTARTS)]
        stages.add(HIDDEN, min(found, key=lambda result: result.rank).restart)
    return stages


def means(scene: Scene, mlps: list[Mlp], part: str) -> tuple[Real, Real]:
    """The mean error of each output on a part of the rows, as recorded and with noise."""
    vectors, noise = scene.vectors(), Disturbance(noise=EXPECTED)
    # These draws were not used in training.
    rng = np.random.default_rng([scene.training.seed, 0, DRAWS])
    drawn = [vectors.with_inputs(noise.of(vectors.inputs, rng)) for _ in range(DRAWS)]
    recorded, *noisy = (_means(scene, mlps, part, given) for given in (vectors, *drawn))
    return recorded, np.mean(noisy, axis=0)


def _means(scene: Scene, mlps: list[Mlp], part: str, vectors: Vectors) -> Real:
    plain = replace(scene, training=replace(scene.training, disturbance=Disturbance()))
    found = []
    for number, mlp in enumerate(mlps):
        task = task_for(plain, vectors, mlps[:number])
        found.append(np.abs(signed_errors(task, mlp, getattr(task, part))).mean())
    return np.array(found)


def _held_out(seed: int, settings: Mapping[str, Any]) -> Iterator[tuple[Real, Real]]:
    for fold in range(FOLDS):
        scene = configured(seed + fold, TRAINED_FOR, settings)
        yield means(scene, trained(scene).tested, "test")


def honest(seed: int) -> Table:
    """The errors on rows, placements and loads that took no part in training."""
    rows: list[list[Cell]] = []
    for name, settings in SPLITS.items():
        recorded, noisy = np.mean(list(_held_out(seed, settings)), axis=0)
        for c, output in enumerate(load_scene(SCENE).outputs):
            rows.append([name, output, float(recorded[c]), float(noisy[c])])
    return Table(
        "honest",
        ["held out", "output", "as recorded %", f"{1e3 * EXPECTED:g} mV %"],
        rows,
        NOTES["honest"],
    )


def robustness(seed: int) -> Table:
    """The errors of networks that are trained for more and more noise."""
    rows: list[list[Cell]] = []
    for noise in NOISES:
        scene = configured(seed, noise, SPLITS["placements"])
        stages = trained(scene)
        found = [*means(scene, stages.written, "every"), *means(scene, stages.tested, "test")]
        for c, output in enumerate(scene.outputs):
            rows.append([1e3 * noise, output, *(float(errors[c]) for errors in found)])
    noisy = f"{1e3 * EXPECTED:g} mV %"
    return Table(
        "robustness",
        [
            "trained for mV",
            "output",
            "as recorded %",
            noisy,
            "held out %",
            f"held out, {noisy}",
        ],
        rows,
        NOTES["robustness"],
    )
