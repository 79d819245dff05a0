"""Errors of a scene's networks on its recorded vectors."""

from __future__ import annotations

import numpy as np

from golden.metrics import OutputError, percent_errors, summarise
from golden.precision import SIGNAL
from golden.scene import Scene
from golden.training.split import split_of


def scene_errors(scene: Scene) -> dict[str, list[OutputError]]:
    """Errors on the recorded vectors: in real arithmetic, bit-true, and bit-true on rows that
    neither trained nor chose the network."""
    vectors = scene.vectors()
    real = scene.process_real(vectors.inputs)
    bit_true = SIGNAL.to_real(scene.twin().process(vectors.codes))
    everything = np.arange(len(vectors.codes))
    held_out = split_of(scene).test
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
