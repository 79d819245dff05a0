"""Errors of a scene's networks on its recorded vectors."""

from __future__ import annotations

import numpy as np

from golden.cli import naming
from golden.metrics import OutputError, percent_errors, summarise
from golden.precision import SIGNAL
from golden.scene import Scene
from golden.training.task import split_rows


def scene_errors(scene: Scene) -> dict[str, list[OutputError]]:
    """Errors on the recorded vectors: in real arithmetic, bit-true, and bit-true on rows that
    neither trained nor chose the network."""
    vectors = scene.vectors()
    real = scene.process_real(vectors.inputs)
    bit_true = SIGNAL.to_real(scene.twin().process(vectors.codes))
    everything = np.arange(len(vectors.codes))
    with naming(scene.data_path):
        held_out = split_rows(len(vectors.codes), scene.training.seed).test
    return {
        name: summarise(
            percent_errors(results[rows], vectors.targets[rows], scene.outputs, scene.full_scale),
            vectors.groups[rows],
        )
        for name, results, rows in (
            ("float", real, everything),
            ("bit-true", bit_true, everything),
            ("bit-true, held out", bit_true, held_out),
        )
    }
