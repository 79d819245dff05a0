"""``python -m golden.training SCENE``: trains the networks that a scene names."""

from __future__ import annotations

import argparse
import platform
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import scipy
from joblib import parallel_config

from golden.cli import run
from golden.fingerprint import fingerprint, sources
from golden.network_files.network_file import provenance_path, save_network
from golden.networks.mlp import Mlp
from golden.progress import Progress
from golden.scene import Scene, load_scene
from golden.training.search import Result, bit_true_errors, candidates, search, train
from golden.training.task import Task, task_for


def choose(task: Task, record: Path, workers: int) -> tuple[Result, int]:
    """The best candidate, and how many were refused; tells of its progress."""
    best: Result | None = None
    refused = 0
    name = ", ".join(task.scene.members[task.number].outputs)
    with Progress(name, len(candidates(task)), "candidates") as progress:
        for result in search(task, record, workers):
            refused += bool(result.refused)
            if not result.refused and (best is None or result.rank < best.rank):
                best = result
            found = f"{best.validation:.2f} % with {best.hidden} hidden nodes" if best else "none"
            progress.step(f"best bit-true validation {found}")
    if best is None:
        raise ValueError(
            f"{task.scene.path}: {name}: all {refused} candidates were refused; the last: "
            f"{result.refused}"
        )
    return best, refused


def main() -> None:
    parser = argparse.ArgumentParser(prog="make train", description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("--workers", type=int, default=-1, help="processes; -1: one a core")
    parser.add_argument("--cluster", help="address of a Dask scheduler to compute on instead")
    parser.add_argument("--build", type=Path, default=Path("build"))
    parser.add_argument("--into", type=Path, help="folder for the networks; beside the scene")
    arguments = parser.parse_args()
    scene = load_scene(arguments.scene)
    if arguments.into:
        members = (
            replace(member, weights_path=arguments.into / member.weights_path.name)
            for member in scene.members
        )
        scene = replace(scene, members=tuple(members))
    with computed_on(arguments.cluster):
        train_scene(scene, arguments.build, arguments.workers)


@contextmanager
def computed_on(cluster: str | None) -> Iterator[None]:
    """Candidates are computed on the Dask scheduler at this address; None: on this machine."""
    if cluster is None:
        yield
        return
    # Imported only where it is asked for: it takes a second.
    from distributed import Client

    try:
        client = Client(cluster, timeout="10s")
    except (OSError, ValueError) as error:
        raise ValueError(f"CLUSTER={cluster}: no scheduler answers: {error}") from None
    with client, parallel_config("dask"):
        yield


def train_scene(scene: Scene, build: Path, workers: int) -> None:
    """Train all networks of the scene, then write them."""
    started = time.monotonic()
    vectors = scene.vectors()
    settings = scene.training
    versions = (np.__version__, scipy.__version__, platform.python_version())
    state = fingerprint([*sources("golden"), scene.path, scene.data_path], *versions)
    records = build / scene.name / "training" / state[:16]
    mlps: list[Mlp] = []
    stories: list[dict[str, str | int | float]] = []
    for number, member in enumerate(scene.members):
        task = task_for(scene, vectors, mlps)
        best, refused = choose(task, records / f"{number}.jsonl", workers)
        mlps.append(train(task, best.hidden, best.restart))
        # Another processor, of a cluster or of a search begun elsewhere, rounds otherwise: what is
        # stated is what the network that is written does.
        validation, test = bit_true_errors(task, mlps[-1])
        total = len(candidates(task))
        stories.append(
            {
                "scene": scene.name,
                "data": scene.data_path.name,
                "arrangement": scene.arrangement,
                "outputs": ", ".join(member.outputs),
                "precision": scene.precision.name,
                "design": scene.design,
                "activation": scene.activation_text,
                "network": ":".join(str(n) for n in mlps[-1].shape),
                "optimiser": settings.optimiser,
                "earlier_outputs": settings.earlier_outputs if number else "none",
                "seed": settings.seed,
                "candidates": total,
                "candidates_refused": refused,
                "hidden": f"{candidates(task)[0][0]} to {candidates(task)[-1][0]}",
                "restarts": settings.restarts,
                "best_restart": best.restart,
                "weight_decay": settings.weight_decay,
                "steps": settings.steps,
                "patience": settings.patience,
                "validation_rms_percent": round(validation, 4),
                "test_rms_percent": round(test, 4),
                "python": versions[2],
                "numpy": versions[0],
                "scipy": versions[1],
            }
        )
    # Written only now: the networks of a cascade belong together.
    for member, mlp, story in zip(scene.members, mlps, stories, strict=True):
        save_network(member.weights_path, mlp, story)
        print(f"wrote {member.weights_path} and {provenance_path(member.weights_path).name}")
    print(f"{time.monotonic() - started:.0f} s")


if __name__ == "__main__":
    sys.exit(run(main))
