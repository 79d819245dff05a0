"""How often networks of learned functions decide wrongly about classes, beside MLPs.

Both learn from the same rows of shipped scenes with classes, each from as many candidates, and the
same validation rows choose. The MLPs have the shape and the settings of the scene. Networks are
chosen and compared in floating point on coded samples. The chosen networks of functions are also
put into small tables.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol, TypeVar

import numpy as np
from joblib import Parallel, delayed

from golden import layer_training, spline_training
from golden.cross_entropy import entropies
from golden.dense import Trained, packed
from golden.networks.table_graph import TableGraph
from golden.real import Real
from golden.scene import Scene, load_scene
from golden.scene.labels import decided
from golden.splines import training as splines
from golden.splines.training import Learned
from golden.task_errors import as_read
from golden.training.objective import Rows
from golden.training.scaling import scaled
from golden.training.task import Task, task_for
from tb.report.measure.table import Cell, Table


@dataclass(frozen=True)
class Study:
    """What is trained on the rows of a scene.

    sums: The hidden sums of the networks of learned functions.
    intervals: Of the splines of an input; with 0 its functions are straight.
    steps: The most evaluations of a descent of functions.
    seeds: How many splits there are; the first is that of the scene.
    candidates: For each network; of functions a third with each penalty on bends.
    """

    scene: str
    sums: tuple[int, ...]
    intervals: int
    steps: int
    seeds: int
    candidates: int

    @property
    def kind(self) -> str:
        """What the table calls the networks of learned functions."""
        return "functions" if self.intervals else "functions of weighted sums"


STUDIES = (
    Study("classes/wine", (2,), 2, 200, seeds=3, candidates=6),
    Study("classes/digits", (4, 8), 0, 100, seeds=3, candidates=6),
)
SCENES = tuple(study.scene for study in STUDIES)
# What a row tells of networks as a mean over the splits.
MEANS = ("parameters", "curved", "straight")
SEEDS = max(study.seeds for study in STUDIES)

NOTES = {
    "learned_classes": "The figures are wrong decisions on held-out rows of scenes with classes, "
    "of networks of learned functions and of MLPs with the shape of the scene's, in floating point "
    "on coded samples. Each column 'wrong' is a split with starts of its own, the first of them "
    "that of the scene. Networks have as many candidates as column 'candidates' says, and the one "
    "with the fewest wrong decisions on the validation rows is taken, among equal ones that with "
    "the least cross-entropy there. 'In tables' are the same networks of functions as a "
    "table_graph with the widths that a scene has by default, bit-true. Parameters, curved and "
    "straight edges are means over the splits.",
}


class Model(Protocol):
    """A network that gives logits."""

    def process(self, frames: Real) -> Real:
        """Logits, shape (frames, classes)."""


Some = TypeVar("Some", bound=Model)


@dataclass(frozen=True)
class Found:
    """A chosen network on one split.

    parameters, curved, straight: The last two are 0 for an MLP.
    rows, wrong: The held-out rows, and on how many the decision is wrong.
    tabled: On how many it is wrong in small tables; None for an MLP.
    """

    parameters: int
    rows: int
    wrong: int
    curved: int = 0
    straight: int = 0
    tabled: int | None = None


def task_of(study: Study, seed: int) -> Task:
    """The rows of a split."""
    scene = load_scene(study.scene)
    training = replace(scene.training, seed=seed)
    scene = scaled(replace(scene, training=training))
    return task_for(scene, scene.vectors(), [])


def wrong(model: Model, rows: Rows) -> int:
    """On how many rows the largest output is not that of the class."""
    return int((decided(model.process(rows.inputs)) != decided(rows.targets)).sum())


def best(models: Sequence[Some], rows: Rows) -> Some:
    """The first of those with the fewest wrong decisions and then the least cross-entropy."""

    def rank(model: Some) -> tuple[int, float]:
        return wrong(model, rows), float(entropies(model.process(rows.inputs), rows.targets).sum())

    return min(models, key=rank)


def mlp(study: Study, seed: int) -> Found:
    """The chosen MLP of a split."""
    task = task_of(study, seed)
    (shape,) = layer_training.layers_searched(task.scene)
    tried = [layer_training.train(task, shape, n) for n in range(study.candidates)]
    chosen = best(tried, task.validation)
    return Found(len(packed(chosen)), len(task.test.inputs), wrong(chosen, task.test))


def with_functions(study: Study, scene: Scene) -> Scene:
    """The scene with learned functions, in small tables."""
    training = replace(
        scene.training,
        functions="spline",
        intervals=(study.intervals,),
        restarts=study.candidates // len(spline_training.CLASS_BENDS),
        steps=study.steps,
    )
    (activation,) = TableGraph.known_activations
    return replace(
        scene,
        training=training,
        design=TableGraph.block,
        activation=activation,
        activation_options={},
        design_options={},
    )


def functions(study: Study, sums: int, seed: int) -> list[Found]:
    """The chosen network of a split, as it was trained and after pruning."""
    task = task_of(study, seed)
    task = replace(task, scene=with_functions(study, task.scene))
    tried = [spline_training.train(task, sums, n) for n in range(study.candidates)]
    chosen = best(tried, task.validation)
    pruned = splines.pruned(chosen, task.training, task.validation, Learned.error)
    return [_found(task, one) for one in (chosen, pruned)]


def _found(task: Task, learned: Learned) -> Found:
    kinds = learned.edges.kinds.tolist()
    return Found(
        learned.parameters,
        len(task.test.inputs),
        wrong(learned, task.test),
        kinds.count(2),
        kinds.count(1),
        _in_tables(task, learned),
    )


def _in_tables(task: Task, learned: Learned) -> int:
    network: Trained
    _, network = as_read(task, spline_training.as_layers(task, learned, task.training))
    outputs = task.bit_true(network, task.test)
    return int((decided(outputs) != decided(task.test.targets)).sum())


def learned_classes(seed: int) -> Table:
    """The wrong decisions of networks of learned functions beside those of MLPs."""
    splits = [(study, seed + n) for study in STUDIES for n in range(study.seeds)]
    jobs = [delayed(mlp)(*split) for split in splits]
    jobs += [delayed(functions)(study, sums, at) for study, at in splits for sums in study.sums]
    results = iter(Parallel(n_jobs=-1)(jobs))
    of_mlp = {split: next(results) for split in splits}
    of_functions = {(*split, sums): next(results) for split in splits for sums in split[0].sums}
    rows: list[list[Cell]] = []
    for study in STUDIES:
        seeds = range(seed, seed + study.seeds)
        rows.append(_row(study, "MLP", [of_mlp[study, at] for at in seeds]))
        for sums in study.sums:
            for n, text in enumerate(("", ", pruned")):
                several = [of_functions[study, at, sums][n] for at in seeds]
                rows.append(_row(study, f"{study.kind}, {sums} sums{text}", several))
    return Table(
        "learned_classes",
        [
            *("scene", "network", "candidates", "parameters", "curved", "straight"),
            "held-out rows",
            *(f"wrong {n + 1}" for n in range(SEEDS)),
            *("wrong %", "in tables %"),
        ],
        rows,
        NOTES["learned_classes"],
    )


def _row(study: Study, name: str, several: Sequence[Found]) -> list[Cell]:
    """A row of the table; the rows held out are those of all splits together."""
    rows = sum(one.rows for one in several)
    in_tables = [one.tabled for one in several if one.tabled is not None]
    edges = [round(float(np.mean([getattr(one, key) for one in several]))) for key in MEANS]
    return [
        study.scene,
        name,
        study.candidates,
        *edges,
        rows,
        *(one.wrong for one in several),
        *[None] * (SEEDS - len(several)),
        100 * sum(one.wrong for one in several) / rows,
        100 * sum(in_tables) / rows if in_tables else None,
    ]
