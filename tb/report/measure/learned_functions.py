"""The errors of networks of learned functions beside those of MLPs, on the same rows.

Both are trained on the same disturbed rows, from as many starts, and chosen by the same validation
rows. Both are measured in floating point, on samples as the converter codes them.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np
from joblib import Parallel, delayed

from golden.dense import Trained, layers_of, packed
from golden.disturbance import Disturbance
from golden.mlp import Mlp, tanh
from golden.precision import SIGNAL
from golden.real import Real
from golden.scene import Scene, load_scene
from golden.scene_errors import disturbed_errors, held_out_means
from golden.splines import training as splines
from golden.splines.training import Learned, SplineSettings
from golden.training import levenberg_marquardt
from golden.training.objective import Objective, Rows, pack, unpack
from golden.training.search import starting_weights
from golden.training.split import Split
from golden.training.task import task_for
from tb.report.measure.bounds import bounds_of
from tb.report.measure.table import Cell, Table

SCENE = "digit"
# The networks of each arrangement, by the outputs that each of them has.
ARRANGEMENTS = {
    "cascade": ((0,), (1,), (2,), (3,)),
    "multiple": ((0,), (1,), (2,), (3,)),
    "single": ((0, 1, 2, 3),),
}
SHIPPED = {"cascade": "digit", "multiple": "digit-multiple", "single": "digit-single"}
SEEDS = 3
CANDIDATES = {"cascade": 30, "multiple": 30, "single": 10}
# How often noise and drift are drawn for each row that is measured.
DRAWS = 10
NOISE = 0.002
DRIFT = Disturbance(gain=0.01, offset=0.005)
# The candidates that are splines: intervals of an input and of a hidden sum, and the penalties.
INTERVALS = ((2, 4), (4, 4))
# The same where the functions of inputs are straight.
STRAIGHT = ((0, 4),)
BENDS = (0.01, 0.03, 0.1)
# The settings of an MLP as in the shipped scenes.
STEPS_MLP, PATIENCE, DECAY = 300, 40, 1e-6

NOTES = {
    "learned_functions": "The figures are mean errors in percent of networks of learned functions, "
    f"and of MLPs, on the data of scene {SCENE}, in floating point on coded samples. The splits "
    "are in blocks of neighbouring placements; the first is that of the scene. 'Held out' is the "
    "quarter of the rows that neither trained nor chose a network, as recorded, for each split; "
    f"'2 mV' and 'drift' are the same rows with noise of {1e3 * NOISE:g} mV, and with a drift of "
    f"{100 * DRIFT.gain:g} % in gain and {1e3 * DRIFT.offset:g} mV in offset, as means over the "
    f"splits. 'All rows, 2 mV' is of networks that were trained on with all rows. Every network is "
    f"the best of {CANDIDATES['cascade']} candidates on the validation rows "
    f"({CANDIDATES['single']} for 'single'), trained for 1 mV. 'Bound' is the "
    "bound of Cramer and Rao. 'Shipped' are the networks of the scenes, bit-true, from 20 to 300 "
    "candidates each; they exist for the first split alone. Parameters and steps are means over "
    "the splits.",
}


class Model(Protocol):
    """A trained network of either kind."""

    @property
    def steps(self) -> int: ...
    @property
    def parameters(self) -> int: ...
    def process(self, frames: Real) -> Real:
        """Outputs, shape (frames, outputs)."""


@dataclass(frozen=True)
class Tanh:
    """An MLP with its steps on an engine."""

    mlp: Mlp

    @property
    def steps(self) -> int:
        """A step for each weight and bias, and two for each tanh."""
        return steps_of(self.mlp)

    @property
    def parameters(self) -> int:
        return len(pack(self.mlp))

    def process(self, frames: Real) -> Real:
        return self.mlp.process(frames)


def steps_of(network: Trained) -> int:
    """The steps of a network with hidden layers of tanh on an engine."""
    return len(packed(network)) + 2 * sum(layer.nodes for layer in layers_of(network)[:-1])


@dataclass(frozen=True)
class Kind:
    """A kind of network: how its candidates are trained, and how one is trained further.

    candidates: The settings that are tried, each from several starts.
    train: Makes a network of settings, random numbers, and training and validation rows.
    refit: Trains a network further on more rows.
    prune: Changes the chosen network, given training and validation rows.
    """

    name: str
    candidates: Sequence[object]
    train: Callable[..., Model]
    refit: Callable[..., Model]
    prune: Callable[..., Model] = field(default=lambda model, training, validation: model)


def train_mlp(hidden: int, rng: np.random.Generator, training: Rows, validation: Rows) -> Tanh:
    """An MLP, trained as in a search for a scene."""
    shape = (training.inputs.shape[1], hidden, training.targets.shape[1])
    return _descended(starting_weights(shape, rng), training, validation)


def refit_mlp(model: Tanh, rows: Rows) -> Tanh:
    """An MLP that is trained further; nothing ends it early."""
    return _descended(model.mlp, rows, rows)


def _descended(mlp: Mlp, training: Rows, validation: Rows) -> Tanh:
    aim = Objective(mlp.shape, tanh, training, validation, DECAY, PATIENCE)
    return Tanh(unpack(aim.search(levenberg_marquardt.descend, pack(mlp), STEPS_MLP), mlp.shape))


def prune(model: Learned, training: Rows, validation: Rows) -> Learned:
    """A network of learned functions with straight and flat edges."""
    return splines.pruned(model, training, validation, rms)


def mlps(hidden: Sequence[int]) -> Kind:
    """MLPs with these numbers of hidden nodes."""
    name = (
        f"MLP, {hidden[0]} to {hidden[-1]} nodes" if len(hidden) > 1 else f"MLP, {hidden[0]} nodes"
    )
    return Kind(name, hidden, train_mlp, refit_mlp)


def learned(nodes: int, pruned: bool = False, straight: bool = False) -> Kind:
    """Networks of learned functions with so many hidden sums, or of functions of weighted sums."""
    what, intervals = (
        ("functions of weighted sums", STRAIGHT) if straight else ("functions", INTERVALS)
    )
    settings = [SplineSettings(nodes, *pair, bend) for pair in intervals for bend in BENDS]
    kind = Kind(f"{what}, {nodes} nodes", settings, splines.trained, splines.refitted)
    return replace(kind, name=f"{kind.name}, pruned", prune=prune) if pruned else kind


KINDS = {
    "cascade": (
        mlps(range(4, 9)),
        learned(2),
        *(learned(nodes, pruned) for nodes in (3, 4) for pruned in (False, True)),
        *(learned(nodes, straight=True) for nodes in (3, 4, 5)),
    ),
    "multiple": (mlps(range(4, 9)), learned(3, True), learned(3, straight=True)),
    "single": (mlps((16,)), learned(4, True), learned(6, straight=True)),
}


@dataclass(frozen=True)
class Lesson:
    """The rows of one split.

    parts: The parts of the split that train and choose, under the noise of the scene, with all
        outputs.
    measured: Those on which errors are measured.
    """

    parts: dict[str, Rows]
    measured: dict[str, Rows]


def lesson(seed: int) -> Lesson:
    """The rows of the split of a seed, as the scene's own training makes them."""
    scene = load_scene(SCENE)
    scene = replace(scene, training=replace(scene.training, seed=seed))
    vectors = scene.vectors()
    task = task_for(scene, vectors, [])
    places = {
        "training": task.split.training,
        "validation": task.split.validation,
        "known": np.concatenate([task.split.training, task.split.validation]),
        "every": np.arange(len(vectors.codes)),
    }
    parts = {}
    for name, rows in places.items():
        inputs = getattr(task, name).inputs
        many = np.tile(rows, len(inputs) // len(rows))
        parts[name] = Rows(inputs, vectors.targets[many], vectors.scale[many])
    return Lesson(parts, dict(_measured(scene, task.split, seed)))


def _measured(scene: Scene, split: Split, seed: int) -> Iterator[tuple[str, Rows]]:
    """The rows on which errors are measured, with draws that were not used in training."""
    vectors = scene.vectors()
    every = np.arange(len(vectors.codes))
    for name, disturbance, rows, draws in (
        ("held out", Disturbance(), split.test, 1),
        ("held out, noise", Disturbance(noise=NOISE), split.test, DRAWS),
        ("held out, drift", DRIFT, split.test, DRAWS),
        ("all rows, noise", Disturbance(noise=NOISE), every, DRAWS),
    ):
        rng = np.random.default_rng([seed, 0, DRAWS])
        many = np.tile(rows, draws)
        # Each row has a drift of its own.
        drawn = np.concatenate([disturbance.of(vectors.inputs[[row]], rng) for row in many])
        inputs = SIGNAL.to_real(scene.codes_of(drawn))
        yield name, Rows(inputs, vectors.targets[many], vectors.scale[many])


def rms(model: Model, rows: Rows) -> float:
    """The root mean square of the errors in percent."""
    return float(np.sqrt((_percent(model, rows) ** 2).mean()))


def _percent(model: Model, rows: Rows) -> Real:
    return np.asarray(100 * (model.process(rows.inputs) - rows.targets) / rows.scale)


@dataclass
class Networks:
    """The networks of an arrangement at the stages of training; see ``golden.training.stages``."""

    arrangement: str
    chosen: list[Model] = field(default_factory=list)
    tested: list[Model] = field(default_factory=list)
    written: list[Model] = field(default_factory=list)

    def outputs(self, models: Sequence[Model], samples: Real) -> list[Real]:
        """The outputs of each network; in a cascade each one sees those before."""
        found: list[Real] = []
        for model in models:
            found.append(model.process(self._seen(samples, found)))
        return found

    def rows(self, models: Sequence[Model], rows: Rows, outputs: Sequence[int]) -> Rows:
        """The rows from which the network after ``models`` learns these outputs."""
        at = list(outputs)
        seen = self._seen(rows.inputs, self.outputs(models, rows.inputs))
        return Rows(seen, rows.targets[:, at], rows.scale[:, at])

    def means(self, models: Sequence[Model], rows: Rows) -> Real:
        """The mean error of each output in percent."""
        outputs = np.concatenate(self.outputs(models, rows.inputs), axis=1)
        miss: Real = np.abs(100 * (outputs - rows.targets) / rows.scale).mean(axis=0)
        return miss

    def _seen(self, samples: Real, earlier: Sequence[Real]) -> Real:
        if self.arrangement != "cascade":
            return samples
        return np.concatenate([samples, *earlier], axis=1)


@dataclass(frozen=True)
class Found:
    """What was found for one kind of network on one split.

    parameters, steps: Of the networks that were trained with all rows.
    means: The mean error of each output in percent, by the rows that were measured.
    """

    parameters: int
    steps: int
    means: dict[str, Real]


def found(arrangement: str, kind: Kind, seed: int, candidates: int) -> Found:
    """Train the networks of an arrangement, and measure them; see ``trained``."""
    given = lesson(seed)
    networks = trained(arrangement, kind, seed, candidates, given)
    means = {
        name: networks.means(networks.written if "all" in name else networks.tested, measured)
        for name, measured in given.measured.items()
    }
    return Found(
        sum(model.parameters for model in networks.written),
        sum(model.steps for model in networks.written),
        means,
    )


def trained(arrangement: str, kind: Kind, seed: int, candidates: int, given: Lesson) -> Networks:
    """Train the networks of an arrangement.

    seed: Of the split, the noise and the starts.
    given: That of the seed.
    """
    networks = Networks(arrangement)
    for number, outputs in enumerate(ARRANGEMENTS[arrangement]):

        def rows(models: list[Model], part: str, at: Sequence[int] = outputs) -> Rows:
            return networks.rows(models, given.parts[part], at)

        training, validation = (rows(networks.chosen, p) for p in ("training", "validation"))
        best = min(
            (
                kind.train(
                    kind.candidates[n % len(kind.candidates)],
                    np.random.default_rng([seed, number, n]),
                    training,
                    validation,
                )
                for n in range(candidates)
            ),
            key=lambda model: rms(model, validation),
        )
        best = kind.prune(best, training, validation)
        tested = kind.refit(best, rows(networks.tested, "known"))
        written = kind.refit(best, rows(networks.written, "every"))
        networks.chosen.append(best)
        networks.tested.append(tested)
        networks.written.append(written)
    return networks


def learned_functions(seed: int) -> Table:
    """The errors, parameters and steps of networks of learned functions beside MLPs."""
    outputs = load_scene(SCENE).outputs
    bounds = {name: at[0] for name, at in bounds_of(load_scene(SCENE), [NOISE]).items()}
    cells = [
        (arrangement, kind, seed + n, CANDIDATES[arrangement])
        for arrangement, kinds in KINDS.items()
        for kind in kinds
        for n in range(SEEDS)
    ]
    all_found = Parallel(n_jobs=-1)(delayed(found)(*cell) for cell in cells)
    rows: list[list[Cell]] = []
    for arrangement, name in SHIPPED.items():
        rows += _shipped(arrangement, load_scene(name), outputs)
        for kind in KINDS[arrangement]:
            several = [
                one
                for cell, one in zip(cells, all_found, strict=True)
                if cell[:2] == (arrangement, kind)
            ]
            for c, output in enumerate(outputs):
                mean = {
                    key: float(np.mean([one.means[key][c] for one in several]))
                    for key in several[0].means
                }
                rows.append(
                    [
                        arrangement,
                        kind.name,
                        output,
                        round(float(np.mean([one.parameters for one in several]))),
                        round(float(np.mean([one.steps for one in several]))),
                        *(float(one.means["held out"][c]) for one in several),
                        *(mean[key] for key in mean if key != "held out"),
                    ]
                )
    return Table(
        "learned_functions",
        [
            "arrangement",
            "network",
            "output",
            "parameters",
            "steps",
            *(f"held out {n + 1} %" for n in range(SEEDS)),
            f"held out, {1e3 * NOISE:g} mV %",
            "held out, drift %",
            f"all rows, {1e3 * NOISE:g} mV %",
            "bound %",
        ],
        [[*row, bounds.get(str(row[2]))] for row in rows],
        NOTES["learned_functions"],
    )


def _shipped(arrangement: str, scene: Scene, outputs: Sequence[str]) -> list[list[Cell]]:
    """The rows of the networks of a scene."""
    held_out: Sequence[float | None] = held_out_means(scene) or [None] * len(outputs)
    noisy = disturbed_errors(scene, Disturbance(noise=NOISE))
    networks = scene.networks()
    size = [sum(map(len, map(packed, networks))), sum(map(steps_of, networks))]
    nothing: list[Cell] = [None] * (SEEDS - 1 + 2)
    return [
        [arrangement, "shipped", output, *size, held_out[at], *nothing, noisy[at]]
        for output in outputs
        for at in [scene.outputs.index(output)]
    ]
