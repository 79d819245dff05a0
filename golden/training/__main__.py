"""``python -m golden.training SCENE``: trains the network that a scene names."""

from __future__ import annotations

import argparse
import platform
import sys

import numpy as np
import scipy

from golden.cli import run
from golden.network_file import provenance_path, save_network
from golden.scene import load_scene
from golden.training.search import Candidate, run_restart, split_rows


def main() -> None:
    parser = argparse.ArgumentParser(prog="make train", description=__doc__)
    parser.add_argument("scene")
    scene = load_scene(parser.parse_args().scene)
    vectors = scene.vectors()
    settings = scene.training
    split_rows(len(vectors.inputs), settings.seed)  # refuses too few rows before any restart
    best: Candidate | None = None
    refused = 0
    for restart in range(settings.restarts):
        try:
            candidate = run_restart(scene, vectors, restart)
        except ValueError as error:
            # Weights that the hardware's formats cannot hold end this restart, not the search.
            refused += 1
            print(f"restart {restart + 1} of {settings.restarts}: refused, {error}")
            continue
        if best is None or candidate.validation_error < best.validation_error:
            best = candidate
        print(
            f"restart {restart + 1} of {settings.restarts}: bit-true validation error "
            f"{candidate.validation_error:.2f} %, best {best.validation_error:.2f} %",
            flush=True,
        )
    if best is None:
        raise ValueError(f"{scene.path}: all {refused} restarts were refused by the formats")
    save_network(
        scene.weights_path,
        best.mlp,
        {
            "scene": scene.name,
            "data": scene.data_path.name,
            "precision": scene.precision.name,
            "activation": scene.activation,
            "network": ":".join(str(n) for n in scene.shape),
            "seed": settings.seed,
            "restarts": settings.restarts,
            "restarts_refused": refused,
            "best_restart": best.restart,
            "weight_decay": settings.weight_decay,
            "steps": settings.steps,
            "validation_rms_percent": round(best.validation_error, 4),
            "test_rms_percent": round(best.test_error, 4),
            "python": platform.python_version(),
            "numpy": np.__version__,
            "scipy": scipy.__version__,
        },
    )
    print(f"wrote {scene.weights_path} and {provenance_path(scene.weights_path).name}")


if __name__ == "__main__":
    sys.exit(run(main))
