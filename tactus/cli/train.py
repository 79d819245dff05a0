"""``make train``: trains the networks that a scene names."""

import json
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed
from threadpoolctl import threadpool_limits

from golden.input_error import InputError
from golden.trained.dense import DenseNetwork
from tactus.core import store
from tactus.core.cli import stop_if_dry_run
from tactus.core.closure import code
from tactus.core.commands import arguments_of
from tactus.core.files import check_output, reading, writing
from tactus.core.finding import refuse
from tactus.core.hold import held
from tactus.core.machine import versions
from tactus.core.progress import Progress
from tactus.network_files.network_file import check_targets, provenance_path, save_networks
from tactus.rig.check import before_training, classes
from tactus.scene import Scene, load_scene
from tactus.scene.known_scales import story
from tactus.scene.training import FEWEST
from tactus.scene.vectors import warn_outside
from tactus.train import search
from tactus.train.few_digits import count_digits
from tactus.train.search import Result, Stages, has_layers, has_many_rows, layers_searched
from tactus.train.splines import search as spline_search
from tactus.train.split import scaled, split_story, unused_text
from tactus.train.task import Task, bit_true_error, percent_errors

# The fewest training rows, and at most as many validation rows, on which candidates are compared.
FIRST_ROWS = 1000


def choose(task: Task, record: Path, workers: int) -> tuple[Result, int]:
    """The best candidate, and how many were refused; prints the progress.

    With many rows, candidates are first compared on parts of them, and the better half goes on.
    """
    kept, parts = tried(task), list(parts_of(task)) if has_many_rows(task.scene) else [task]
    refused = set[tuple[Any, ...]]()
    for part in parts:
        rows = len(part.training.inputs)
        own = record if part is task else record.with_name(f"{record.stem}-{rows}.jsonl")
        ranked = sorted(compared(part, kept, own, workers), key=lambda one: one.rank)
        refused |= {(one.layers, one.restart) for one in ranked if one.refused}
        kept = [(one.layers, one.restart) for one in ranked[: -(-len(ranked) // 2)]]
    return ranked[0], len(refused)


def compared(
    task: Task, chosen: Sequence[tuple[Any, ...]], record: Path, workers: int
) -> list[Result]:
    """The results of some candidates, one of which is not refused; prints the progress."""
    name = task.scene.classes or ", ".join(task.scene.members[task.number].outputs)
    if has_many_rows(task.scene):
        name += f", {len(task.training.inputs)} rows"
    own, seen = costs(task, chosen), list[Result]()
    known = record.read_bytes().count(b"\n") if record.is_file() else 0
    with Progress(name, len(own), "candidates", costs=own, known=known) as progress:
        for result in continued(training_of(task.scene).measure, task, chosen, record, workers):
            seen.append(result)
            best = min(seen, key=lambda one: one.rank)
            found = "none" if best.refused else f"{best.validation:.2f} % with {nodes_of(best)}"
            progress.step(f"best bit-true validation {found}")
    if best.refused:
        raise InputError(
            f"{task.scene.path}: {name}: all {len(seen)} candidates were refused; the last: "
            f"{seen[-1].refused}"
        )
    return seen


def continued(
    measured: Callable[..., Result],
    task: Task,
    candidates: Sequence[tuple[Any, ...]],
    record: Path,
    workers: int,
) -> Iterator[Result]:
    """The results of all candidates, in order, of a search that can be interrupted.

    measured: Trains and measures one candidate of a task.
    candidates: What it gets beside the task.
    record: A line for each result, in the order of the candidates. Those that an earlier search has
        left are not computed again.
    workers: The number of processes; -1 for one on each core.
    """
    known = list(_read(record))
    yield from known
    with writing(record):
        record.parent.mkdir(parents=True, exist_ok=True)
        lines = [json.dumps(asdict(result)) + "\n" for result in known]
        # An earlier search may have been interrupted within a line.
        record.write_text("".join(lines), encoding="utf-8")
    jobs = (delayed(measured)(task, *candidate) for candidate in candidates[len(known) :])
    for result in Parallel(n_jobs=workers, return_as="generator")(jobs):
        with writing(record), record.open("a", encoding="utf-8") as handle:
            handle.write(json.dumps(asdict(result)) + "\n")
        yield result


def parts_of(task: Task) -> Iterator[Task]:
    """The task on random rows, each time on those before and as many more; the last has all.

    After each of them the worse half of the candidates is left out (K. Jamieson and A. Talwalkar,
    "Non-stochastic best arm identification and hyperparameter optimization", AISTATS 2016).
    """
    rng = np.random.default_rng([task.scene.training.seed, task.number])
    frames = {name: getattr(task, name) for name in ("training", "validation")}
    orders = {name: rng.permutation(len(part.inputs)) for name, part in frames.items()}
    rows = FIRST_ROWS
    while rows < len(task.training.inputs):
        yield replace(task, **{n: part.take(orders[n][:rows]) for n, part in frames.items()})
        rows *= 2
    yield task


def _read(record: Path) -> Iterator[Result]:
    if not record.is_file():
        return
    with reading(record, "a record of candidates, which may be deleted"):
        for line in record.read_text(encoding="utf-8").split("\n")[:-1]:
            facts = json.loads(line)
            yield Result(**facts | {"layers": tuple(facts["layers"])})


def main() -> None:
    arguments = arguments_of("train", __doc__, workers=int)
    scene = load_scene(arguments.scene)
    check_layers(scene)
    refuse(before_training(scene, arguments.build))
    for path in filter(Path.exists, scene.network_files):
        # Only training writes a provenance; without it the network was brought from elsewhere.
        check_output(
            path,
            own=lambda there: provenance_path(there).exists(),
            force=arguments.force,
            key="network.weights",
        )
    stop_if_dry_run(
        f"train {len(scene.members)} networks and write {', '.join(map(str, scene.network_files))}"
    )
    # -1: a process on each core
    train_scene(scene, arguments.build, arguments.workers or -1)


def nodes_of(result: Result) -> str:
    """The hidden nodes of a candidate, such as "hidden layers of 9, 9 nodes"."""
    if len(result.layers) > 1:
        return f"hidden layers of {', '.join(map(str, result.layers))} nodes"
    return f"{sum(result.layers)} hidden nodes"


def training_of(scene: Scene) -> Any:
    """The module that trains the networks of a scene."""
    return spline_search if scene.training.functions else search


def tried(task: Task) -> Sequence[tuple[Any, ...]]:
    """The hidden nodes of each layer and the number of the start of every candidate."""
    return list(training_of(task.scene).candidates(task))


def costs(task: Task, chosen: Sequence[tuple[Any, ...]]) -> list[float]:
    """About how long each candidate takes, compared with the others.

    A descent of small networks of any kind takes about the time of the number of weights to the
    power of 1.5, as measured with 25 to 226 weights.
    """
    member = task.scene.members[task.number]
    found = []
    for layers, *_ in chosen:
        widths = (member.inputs, *layers, len(member.outputs))
        found.append(sum((a + 1) * b for a, b in pairwise(widths)) ** 1.5)
    return found


def check_layers(scene: Scene) -> None:
    """Refuse activations of layers whose nodes nobody names."""
    for member in scene.members:
        if member.activations not in ((), ("tanh",)) and not member.layers:
            raise InputError(
                f"{scene.path}: network.hidden: got 0 with activations, expected the nodes of each "
                f"hidden layer, {', '.join(member.activations)}; or training.layers instead, with "
                "which training searches for them"
            )


def train_scene(scene: Scene, build: Path, workers: int) -> None:
    """Train all networks of the scene, and then write them."""
    started = time.monotonic()
    check_targets(scene.weights_paths)
    scene = scaled(scene)
    warn_outside(scene)
    for finding in classes(scene):
        print(finding)
    unused = unused_text(scene)
    if unused:
        print(f"{len(scene.vectors().codes)} rows; {unused}")
    settings = scene.training
    trains = training_of(scene)
    tools = versions("numpy", "scipy", "python")
    asked = store.key(
        "training",
        code=code([trains.__name__]),
        scene=[scene.path, *scene.data_paths],
        tools=[f"{name} {version}" for name, version in tools.items()],
    )
    records = store.place(asked, build, suffix="")
    stages: Any = trains.Stages(scene)
    stories: list[dict[str, Any]] = []
    for number, member in enumerate(scene.members):
        task = stages.task(stages.chosen, number)
        # A second command that searches for the same waits, and takes what the first has found.
        with held([records]):
            best, refused = choose(task, records / f"{number}.jsonl", workers)
        # On several threads a large product rounds in another way.
        with threadpool_limits(1 if has_many_rows(scene) else None):
            stages.add(best.layers, best.restart)
        # The processor on which the search began may round in another way. Therefore the errors
        # are computed again for these networks.
        errors: dict[str, Any] = {}
        for stage, part in (("chosen", "validation"), ("tested", "test"), ("written", "every")):
            networks = getattr(stages, stage)
            errors |= errors_of(stages.task(networks, number), networks[number], part)
        few = digits_story(stages, number) if settings.digits else {}
        if settings.functions:
            few = {"functions": settings.functions, **stages.edges[number]}
        stories.append(
            {
                "scene": scene.name,
                **split_story(scene),
                "arrangement": scene.arrangement,
                "outputs": ", ".join(member.outputs),
                **({"classes": scene.classes, "labels": scene.labels} if scene.labels else {}),
                "precision": scene.precision.name,
                "design": scene.design,
                "activation": scene.activation_text,
                "network": ":".join(str(n) for n in stages.written[number].shape),
                "optimiser": settings.optimiser,
                "earlier_outputs": settings.earlier_outputs if number else "none",
                "candidates": len(tried(task)),
                "candidates_refused": refused,
                "hidden": searched_text(task),
                "restarts": settings.restarts,
                "best_restart": best.restart,
                "weight_decay": settings.weight_decay,
                "steps": settings.steps,
                "patience": settings.patience,
                "refit": settings.refit,
                "noise": settings.disturbance.noise,
                "drift_gain": settings.disturbance.gain,
                "drift_offset": settings.disturbance.offset,
                **few,
                **errors,
                **{name: tools[name] for name in ("python", "numpy", "scipy")},
                **story(scene.known_scales, stages.files[number]),
            }
        )
    # All files are written or none, because the networks of a cascade belong together.
    save_networks(list(zip(scene.weights_paths, stages.files, stories, strict=True)))
    for path in scene.network_files:
        print(f"wrote {path} and {provenance_path(path).name}")
    print(f"{time.monotonic() - started:.0f} s")


def searched_text(task: Task) -> str:
    """Which hidden nodes and layers were tried, for the provenance."""
    scene = task.scene
    if scene.training.layers:
        low, high = scene.training.layers
        nodes = sorted({layers[0] for layers in layers_searched(scene) if layers})
        return f"{low} to {high} layers of {', '.join(map(str, nodes))} {scene.training.activation}"
    if has_layers(scene):
        return scene.members[task.number].text
    nodes = [sum(layers) for layers in layers_searched(scene, task.number)]
    return f"{nodes[0]} to {nodes[-1]}"


def digits_story(stages: Stages, number: int) -> dict[str, Any]:
    """The entries of a provenance about the signed digits of a network.

    They are the digits that were requested, those before and after, and the errors before.
    """
    settings, width = stages.scene.training, stages.scene.precision.coeff_width
    before = stages.full[number]
    digits = [count_digits(mlp, width) for mlp in (before["written"], stages.written[number])]
    name = ", ".join(stages.scene.members[number].outputs)
    print(f"{name}: {digits[1]} signed digits of {digits[0]}")
    errors = (
        errors_of(stages.task(stages.chosen, number), before["chosen"], "validation")
        | errors_of(stages.task(stages.tested, number), before["tested"], "test")
        | errors_of(stages.task(stages.written, number), before["written"], "every")
    )
    fewest = settings.digits == FEWEST
    return {
        "digits_asked": settings.digits,
        "digits_tolerance": settings.digits_tolerance if fewest else 0.0,
        "digits_before": digits[0],
        "digits": digits[1],
        **{f"before_{key}": value for key, value in errors.items()},
    }


def errors_of(task: Task, network: DenseNetwork, part: str) -> dict[str, Any]:
    """The entries of a provenance about a network's errors on a part of the rows.

    The errors are those on rows as recorded and, where the scene declares noise or drift, on
    disturbed rows, unless the network was trained on these very draws.
    """
    kinds = {"": task.recorded.take(task.rows(part))}
    if part != "every" and not task.scene.training.disturbance.none:
        kinds["_disturbed"] = getattr(task, part)
    errors: dict[str, Any] = {}
    for kind, frames in kinds.items():
        means = np.abs(percent_errors(task, network, frames)).mean(axis=0)
        names = task.scene.members[task.number].outputs
        figure = "wrong" if task.scene.labels else "rms"
        errors[f"{part}{kind}_{figure}_percent"] = round(bit_true_error(task, network, frames), 4)
        errors[f"{part}{kind}_mean_percent"] = {
            name: round(float(mean), 4) for name, mean in zip(names, means, strict=True)
        }
    return errors
