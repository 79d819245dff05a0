"""``python -m golden.training SCENE``: trains the network that a scene names."""

from __future__ import annotations

import argparse
import platform
import sys
import time
from pathlib import Path

import numpy as np
import scipy

from golden.cli import run
from golden.fingerprint import fingerprint, sources
from golden.network_file import provenance_path, save_network
from golden.scene import load_scene
from golden.training.search import Result, candidates, search, train


def main() -> None:
    parser = argparse.ArgumentParser(prog="make train", description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("--workers", type=int, default=-1, help="processes; -1: one a core")
    parser.add_argument("--build", type=Path, default=Path("build"))
    arguments = parser.parse_args()
    scene = load_scene(arguments.scene)
    vectors = scene.vectors()
    settings = scene.training
    versions = (np.__version__, scipy.__version__, platform.python_version())
    inputs = [*sources("golden"), scene.path, scene.data_path]
    state = fingerprint(inputs, *versions)
    record = arguments.build / scene.name / "training" / f"{state[:16]}.jsonl"
    total = len(candidates(scene))
    best: Result | None = None
    refused = 0
    told = -np.inf
    for done, result in enumerate(search(scene, vectors, record, arguments.workers), start=1):
        refused += bool(result.refused)
        better = not result.refused and (best is None or result.rank < best.rank)
        best = result if better else best
        if better or done == total or time.monotonic() - told > 5:
            told = time.monotonic()
            found = f"{best.validation:.2f} % with {best.hidden} hidden nodes" if best else "none"
            print(f"{done} of {total} candidates: best bit-true validation {found}", flush=True)
    if best is None:
        raise ValueError(
            f"{scene.path}: all {refused} candidates were refused; the last: {result.refused}"
        )
    save_network(
        scene.weights_path,
        train(scene, vectors, best.hidden, best.restart),
        {
            "scene": scene.name,
            "data": scene.data_path.name,
            "precision": scene.precision.name,
            "activation": scene.activation_text,
            "network": f"{len(scene.sensors)}:{best.hidden}:{len(scene.outputs)}",
            "optimiser": settings.optimiser,
            "seed": settings.seed,
            "candidates": total,
            "candidates_refused": refused,
            "restarts": settings.restarts,
            "best_restart": best.restart,
            "weight_decay": settings.weight_decay,
            "steps": settings.steps,
            "validation_rms_percent": round(best.validation, 4),
            "test_rms_percent": round(best.test, 4),
            "python": versions[2],
            "numpy": versions[0],
            "scipy": versions[1],
        },
    )
    print(f"wrote {scene.weights_path} and {provenance_path(scene.weights_path).name}")


if __name__ == "__main__":
    sys.exit(run(main))
