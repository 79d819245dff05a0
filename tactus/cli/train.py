"""``make train``: trains the networks that a scene names."""

import argparse
import platform
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from golden.input_error import InputError
from golden.trained.dense import Trained
from tactus.core import store
from tactus.core.cli import run, stop_if_dry_run
from tactus.core.closure import code
from tactus.core.files import check_output
from tactus.core.finding import refuse
from tactus.core.folders import BUILD
from tactus.core.hold import held
from tactus.core.progress import Progress
from tactus.network_files.network_file import check_targets, provenance_path, save_networks
from tactus.rig import class_counts
from tactus.rig.check import before_training
from tactus.scene import Scene, load_scene
from tactus.scene.schema import FEWEST
from tactus.scene.trained_scale import story
from tactus.scene.vectors import warn_outside
from tactus.train import layer_training, spline_training
from tactus.train.candidate_runs import continued
from tactus.train.descent.cluster import computed_on
from tactus.train.descent.few_digits import count_digits
from tactus.train.descent.scaling import scaled
from tactus.train.descent.search import Result, candidates, search
from tactus.train.descent.split import split_story, unused_text
from tactus.train.descent.stages import Stages
from tactus.train.descent.task import Task
from tactus.train.layer_training import LayersResult, LayerStages, layers_searched
from tactus.train.spline_training import SplineStages
from tactus.train.task_errors import bit_true_error, percent_errors

TOOLS = ("numpy", "scipy", "python")


def choose(task: Task, record: Path, workers: int) -> tuple[Result, int]:
    """The best candidate, and how many were refused; prints the progress."""
    best: Result | None = None
    refused = 0
    member = task.scene.members[task.number]
    name = task.scene.classes or ", ".join(member.outputs)
    results: Iterator[Result]
    if has_layers(task.scene):
        results = continued(
            layer_training.measured, LayersResult, task, tried(task), record, workers
        )
    elif task.scene.training.functions:
        results = continued(spline_training.measured, Result, task, tried(task), record, workers)
    else:
        results = search(task, record, workers)
    later = range(task.number + 1, len(task.scene.members))
    behind = sum(sum(costs(replace(task, number=number))) for number in later)
    own = costs(task)
    # A line each.
    known = record.read_bytes().count(b"\n") if record.is_file() else 0
    with Progress(name, len(own), "candidates", costs=own, behind=behind, known=known) as progress:
        for result in results:
            refused += bool(result.refused)
            if not result.refused and (best is None or result.rank < best.rank):
                best = result
            found = f"{best.validation:.2f} % with {nodes_of(best)}" if best else "none"
            progress.step(f"best bit-true validation {found}")
    if best is None:
        raise InputError(
            f"{task.scene.path}: {name}: all {refused} candidates were refused; the last: "
            f"{result.refused}"
        )
    return best, refused


def main() -> None:
    parser = argparse.ArgumentParser(prog="make train", description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("--workers", type=int, default=-1, help="processes; -1: one a core")
    parser.add_argument("--cluster", help="address of a Dask scheduler to compute on instead")
    parser.add_argument("--build", type=Path, default=BUILD)
    parser.add_argument("--into", type=Path, help="folder for the networks; beside the scene")
    parser.add_argument("--force", action="store_true", help="replace networks from elsewhere")
    arguments = parser.parse_args()
    scene = load_scene(arguments.scene)
    if arguments.into:
        members = (
            replace(member, weights_path=arguments.into / member.weights_path.name)
            for member in scene.members
        )
        scene = replace(scene, members=tuple(members))
    check_layers(scene)
    refuse(before_training(scene, arguments.build))
    for path in filter(Path.exists, scene.weights_paths):
        # Only training writes a provenance; without it the network was brought from elsewhere.
        check_output(
            path,
            own=lambda there: provenance_path(there).exists(),
            force=arguments.force,
            key="network.weights",
        )
    stop_if_dry_run(
        f"train {len(scene.members)} networks and write {', '.join(map(str, scene.weights_paths))}"
    )
    with computed_on(arguments.cluster):
        train_scene(scene, arguments.build, arguments.workers)


def nodes_of(result: Result) -> str:
    """The hidden nodes of a candidate, such as "hidden layers of 9, 9 nodes"."""
    if isinstance(result, LayersResult) and len(result.layers) > 1:
        return f"hidden layers of {', '.join(map(str, result.layers))} nodes"
    return f"{result.hidden} hidden nodes"


def has_layers(scene: Scene) -> bool:
    """Whether training is that of ``tactus.train.layer_training``: of any layers, and of
    classes."""
    if scene.training.functions:
        return False
    return bool(scene.labels or scene.members[0].layers or scene.training.layers)


def tried(task: Task) -> Sequence[tuple[Any, int]]:
    """The hidden nodes, or those of each layer, and the number of the start of every candidate."""
    if has_layers(task.scene):
        return layer_training.candidates(task)
    if task.scene.training.functions:
        return spline_training.candidates(task)
    return candidates(task)


def costs(task: Task) -> list[float]:
    """About how long each candidate takes, compared with the others.

    A descent of small networks of any kind takes about the time of the number of weights to the
    power of 1.5, as measured with 25 to 226 weights.
    """
    member = task.scene.members[task.number]
    found = []
    for hidden, _ in tried(task):
        layers = hidden if isinstance(hidden, tuple) else (hidden,)
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
    for finding in class_counts.findings(scene):
        print(finding)
    unused = unused_text(scene)
    if unused:
        print(f"{len(scene.vectors().codes)} rows; {unused}")
    settings = scene.training
    made = LayerStages if has_layers(scene) else SplineStages if settings.functions else Stages
    versions = (np.__version__, scipy.__version__, platform.python_version())
    asked = store.key(
        "training",
        code=code([made.__module__, search.__module__]),
        scene=[scene.path, *scene.data_paths],
        tools=[f"{name} {version}" for name, version in zip(TOOLS, versions, strict=True)],
    )
    records = store.place(asked, build, suffix="")
    stages: Any = made(scene)
    stories: list[dict[str, Any]] = []
    for number, member in enumerate(scene.members):
        task = stages.task(stages.chosen, number)
        # A second command that searches for the same waits, and takes what the first has found.
        with held([records]):
            best, refused = choose(task, records / f"{number}.jsonl", workers)
        hidden = best.layers if isinstance(best, LayersResult) else best.hidden
        stages.add(hidden, best.restart)
        # The processors of a cluster, or of a machine on which the search began, may round in
        # another way. Therefore the errors are computed again for these networks.
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
                "python": versions[2],
                "numpy": versions[0],
                "scipy": versions[1],
                **story(scene.known_scales, stages.files[number]),
            }
        )
    # All files are written or none, because the networks of a cascade belong together.
    save_networks(list(zip(scene.weights_paths, stages.files, stories, strict=True)))
    for member in scene.members:
        print(f"wrote {member.weights_path} and {provenance_path(member.weights_path).name}")
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
    nodes = [hidden for hidden, _ in candidates(task)]
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


def errors_of(task: Task, network: Trained, part: str) -> dict[str, Any]:
    """The entries of a provenance about a network's errors on a part of the rows.

    The errors are those on rows as recorded and, where the scene declares noise or drift, on
    disturbed rows, unless the network was trained on these very draws.
    """
    rows = np.arange(len(task.recorded.codes)) if part == "every" else getattr(task.split, part)
    kinds = {"": task.recorded.take(rows)}
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


if __name__ == "__main__":
    sys.exit(run(main))
