"""The errors of networks of learned functions beside those of MLPs, on other scenes of numbers.

These are the swing with its past, and the rig of the tutorial. Networks of both kinds learn from
the same rows, from as many candidates, with the settings of the scene, and the same validation rows
choose. As in ``learned_functions`` they are measured in floating point on coded samples.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from joblib import Parallel, delayed

from golden.fingerprint import ROOT
from golden.mlp import Mlp, tanh
from golden.precision import SIGNAL
from golden.scene import Scene, load_scene
from golden.scene.sections import Training
from golden.splines.training import SplineSettings
from golden.training import levenberg_marquardt
from golden.training.objective import Objective, Rows, pack, unpack
from golden.training.search import starting_weights
from golden.training.split import split_of
from tb.report.measure.learned_functions import (
    INTERVALS,
    Found,
    Kind,
    Model,
    Networks,
    Tanh,
    learned,
    mlps,
    rms,
)
from tb.report.measure.table import Cell, Table


@dataclass(frozen=True)
class Study:
    """What is trained on the rows of a scene.

    scene: The name of the scene, or the path of its file.
    hidden: The hidden nodes of the MLPs, as many candidates of each.
    candidates: For each network, of either kind.
    every: One row of so many trains or chooses.
    """

    name: str
    scene: str
    hidden: tuple[int, ...]
    candidates: int
    every: int = 1


STUDIES = (
    Study("swing-window", "swing-window", (10,), candidates=8, every=2),
    Study("tutorial", str(ROOT / "docs" / "tutorial" / "rig.toml"), tuple(range(4, 13)), 72),
)
SCENES = tuple(study.scene for study in STUDIES)
# The hidden sums of networks of functions, and the penalties on bends that are tried for each.
SUMS = (2, 3)
BENDS = (0.001, 0.01, 0.1, 1.0)
SEEDS = 3
HELD_OUT = "held out"

NOTES = {
    "learned_elsewhere": "The figures are mean errors in percent on held-out rows, as recorded, of "
    "networks of learned functions and of MLPs, in floating point on coded samples. Each column "
    "'held out' is a split with starts of its own, the first of them that of the scene. Scene "
    "'tutorial' is the rig of the tutorial. Of the rows of swing-window every second one of those "
    "that train or choose is used, for both kinds of network. Each network is the best on the "
    "validation rows of as many candidates as column 'candidates' says. Steps, patience, weight "
    "decay and refit are those of the scene. Parameters and steps on an engine are means over the "
    "splits.",
}


def scene_of(study: Study, seed: int) -> Scene:
    """The scene with the split of a seed."""
    scene = load_scene(study.scene)
    return replace(scene, training=replace(scene.training, seed=seed))


def parts_of(study: Study, scene: Scene) -> dict[str, Rows]:
    """The rows that train, choose, train on and are held out, with all outputs of the scene."""
    vectors, split = scene.vectors(), split_of(scene)
    places = {name: getattr(split, name)[:: study.every] for name in ("training", "validation")}
    places["known"] = np.concatenate(list(places.values()))
    places[HELD_OUT] = split.test
    inputs = SIGNAL.to_real(vectors.codes)
    return {
        name: Rows(inputs[rows], vectors.targets[rows], vectors.scale[rows])
        for name, rows in places.items()
    }


def mlp_kind(hidden: Sequence[int], settings: Training) -> Kind:
    """MLPs with the settings of a scene."""

    def descended(mlp: Mlp, training: Rows, validation: Rows) -> Tanh:
        aim = Objective(
            mlp.shape, tanh, training, validation, settings.weight_decay, settings.patience
        )
        point = aim.search(levenberg_marquardt.descend, pack(mlp), settings.steps)
        return Tanh(unpack(point, mlp.shape))

    def train(nodes: int, rng: np.random.Generator, training: Rows, validation: Rows) -> Tanh:
        shape = (training.inputs.shape[1], nodes, training.targets.shape[1])
        return descended(starting_weights(shape, rng), training, validation)

    def refit(model: Tanh, rows: Rows) -> Tanh:
        return descended(model.mlp, rows, rows)

    return replace(mlps(hidden), train=train, refit=refit)


def function_kinds(sums: int, settings: Training) -> list[Kind]:
    """Networks of learned functions with the settings of a scene, whole and pruned."""
    candidates = [
        SplineSettings(sums, *pair, bend, settings.weight_decay, settings.steps, settings.patience)
        for pair in INTERVALS
        for bend in BENDS
    ]
    return [replace(learned(sums, pruned), candidates=candidates) for pruned in (False, True)]


def groups(study: Study) -> list[list[Kind]]:
    """The kinds of network of a study; those of a group come from the same candidates."""
    settings = load_scene(study.scene).training
    return [
        [mlp_kind(study.hidden, settings)],
        *(function_kinds(sums, settings) for sums in SUMS),
    ]


def found(study: Study, kinds: Sequence[Kind], seed: int) -> list[Found]:
    """Train the networks of a scene on one split, and measure them.

    kinds: The first one trains the candidates. Each kind prunes the chosen ones in its own way.
    seed: Of the split and the starts.
    """
    scene = scene_of(study, seed)
    parts = parts_of(study, scene)
    several = [Networks(scene.arrangement) for _ in kinds]
    for number, member in enumerate(scene.members):
        outputs = [scene.outputs.index(name) for name in member.outputs]
        best = chosen(study, kinds[0], [seed, number], *_rows(several[0], parts, outputs))
        for kind, networks in zip(kinds, several, strict=True):
            model = kind.prune(best, *_rows(networks, parts, outputs))
            known = networks.rows(networks.tested, parts["known"], outputs)
            networks.chosen.append(model)
            networks.tested.append(kind.refit(model, known) if scene.training.refit else model)
    return [
        Found(
            sum(model.parameters for model in networks.tested),
            sum(model.steps for model in networks.tested),
            {HELD_OUT: networks.means(networks.tested, parts[HELD_OUT])},
        )
        for networks in several
    ]


def chosen(study: Study, kind: Kind, numbers: list[int], training: Rows, validation: Rows) -> Model:
    """The candidate with the least error on the validation rows."""
    tried = (
        kind.train(
            kind.candidates[n % len(kind.candidates)],
            np.random.default_rng([*numbers, n]),
            training,
            validation,
        )
        for n in range(study.candidates)
    )
    return min(tried, key=lambda model: rms(model, validation))


def _rows(networks: Networks, parts: dict[str, Rows], outputs: Sequence[int]) -> list[Rows]:
    """The rows that train and choose the network after the chosen ones."""
    names = ("training", "validation")
    return [networks.rows(networks.chosen, parts[name], outputs) for name in names]


def learned_elsewhere(seed: int) -> Table:
    """The errors, parameters and steps of networks of learned functions beside MLPs."""
    jobs = [
        (study, kinds, seed + n)
        for study in STUDIES
        for kinds in groups(study)
        for n in range(SEEDS)
    ]
    results = Parallel(n_jobs=-1)(delayed(found)(*job) for job in jobs)
    rows: list[list[Cell]] = []
    for at in range(0, len(jobs), SEEDS):
        study, kinds, _ = jobs[at]
        for kind, several in zip(kinds, zip(*results[at : at + SEEDS], strict=True), strict=True):
            rows += _lines(study, kind, several)
    return Table(
        "learned_elsewhere",
        [
            *("scene", "network", "candidates", "parameters", "steps", "output"),
            *(f"held out {n + 1} %" for n in range(SEEDS)),
            "mean %",
        ],
        rows,
        NOTES["learned_elsewhere"],
    )


def _lines(study: Study, kind: Kind, several: Sequence[Found]) -> list[list[Cell]]:
    """The lines of a network, one for each output."""
    sizes = [[one.parameters, one.steps] for one in several]
    means = np.array([one.means[HELD_OUT] for one in several])
    first = [
        study.name,
        kind.name,
        study.candidates,
        *np.mean(sizes, axis=0).round().astype(int).tolist(),
    ]
    return [
        [*first, output, *errors.tolist(), float(errors.mean())]
        for output, errors in zip(load_scene(study.scene).outputs, means.T, strict=True)
    ]
