"""Errors of a scene's networks on its recorded vectors."""

from __future__ import annotations

import numpy as np

from golden.metrics import OutputError, summarise
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
        name: summarise(vectors.percent_errors(results)[rows], vectors.groups[rows])
        for name, results, rows in (
            ("float", real, everything),
            ("bit-true", bit_true, everything),
            ("bit-true, held out", bit_true, held_out),
        )
    }


def unit_errors(scene: Scene) -> dict[str, OutputError]:
    """Bit-true errors on the recorded vectors in the units of the outputs that have a scale or a
    unit, by output."""
    vectors = scene.vectors()
    results = scene.outputs_in_units(scene.twin().process(vectors.codes))
    found = summarise(np.abs(results - scene.in_units(vectors.targets)), vectors.groups)
    named = scene.scale.keys() | scene.units.keys()
    return {name: error for name, error in zip(scene.outputs, found, strict=True) if name in named}
