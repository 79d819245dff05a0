"""``python -m golden.recalibration SCENE``: gain and offset of each sensor from known placements.

Without placements it proposes some: those of the recording that tell most.
"""

from __future__ import annotations

import argparse
import hashlib
import sys
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np

from golden.cli import run, would
from golden.networks.mlp import Real
from golden.precision import SIGNAL
from golden.recalibration.choice import information_of, placement, proposal, refuse_unsure
from golden.recalibration.fit import Sensitivity, fit
from golden.recalibration.folder import scene_file, write_copy
from golden.scene import Scene, Vectors, load_scene
from golden.scene.scale import readings

# Placements that are proposed where there are none: with fewer the error of one weighs much.
PROPOSED = 8

# An error after the fit that is so many times the scene's own tells of more than gain and offset.
MOST_LEFT = 3.0


def main() -> None:
    parser = argparse.ArgumentParser(prog="make recalibrate", description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("csv", nargs="?", default="", help="readings and their known outputs")
    parser.add_argument("to", nargs="?", default="", help="folder or scene file of the copy")
    arguments = parser.parse_args()
    scene = load_scene(arguments.scene)
    if not scene.window.plain:
        raise ValueError(
            f"{scene.path}: data.window: got one that reaches {scene.window.past} frames back, "
            "expected none: placements are known one by one"
        )
    if len(scene.data_paths) > 1:
        raise ValueError(
            f"{scene.path}: data.recordings: got {len(scene.data_paths)}, expected data.file: the "
            "copy of a scene has one recording"
        )
    if arguments.csv:
        recalibrate(scene, Path(arguments.csv), scene_file(scene, arguments.to))
    else:
        propose(scene)


def propose(scene: Scene) -> None:
    """Print placements that tell most of the sensors."""
    would(f"print placements that tell most of the sensors of scene {scene.name}")
    recorded = Sensitivity.of(scene)
    nothing = np.zeros((2 * len(scene.sensors),) * 2)
    print("placements that tell most, one after the other, and what gains and offsets that are")
    print("still unsure then add to the error of the worst output, as a part of its own:")
    for count, (row, added) in enumerate(proposal(recorded, nothing, PROPOSED), start=1):
        print(f"{count:3}  {added:8.2f}  {placement(scene, row)}")
    print("read the sensors there and give the rows as CSV= with the columns of the scene")


def recalibrate(scene: Scene, path: Path, target: Path) -> None:
    """Fit, tell, write."""
    placements = replace(scene, data_paths=(path,), group_by="", where={}).vectors()
    recorded = Sensitivity.of(scene)
    correction = fit(scene, recorded, placements)
    samples = readings(placements.inputs, correction)
    known = placements.with_inputs(samples)
    try:
        refuse_unsure(scene, recorded, information_of(scene, recorded, known), len(samples))
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    would(f"write {target}")
    told = {
        "recalibrated_from": scene.name,
        "recalibrated_with": path.name,
        "recalibrated_with_sha256": hashlib.sha256(path.read_bytes()).hexdigest(),
        "placements": len(samples),
        "correction": {
            name: {"gain": one.factor, "offset": one.offset}
            for name, one in zip(scene.sensors, correction, strict=True)
        },
    }
    written = write_copy(scene, correction, told, target)
    print("signal to the networks = gain * signal of the sensor + offset")
    for name, one in zip(scene.sensors, correction, strict=True):
        print(f"{name}: gain {one.factor:.5f}, offset {one.offset:+.5f}")
    tell_errors(scene, load_scene(str(target)), recorded, placements)
    print("\n".join(f"wrote {file}" for file in written))


def tell_errors(scene: Scene, copy: Scene, recorded: Sensitivity, placements: Vectors) -> None:
    """Print the errors at the placements, bit-true, before and after."""
    before, after = (_errors(one, placements) for one in (scene, copy))
    print(f"\n{'output':16}{'before %':>10}{'after %':>10}{'recorded %':>12}")
    own = _errors(scene, scene.vectors())
    for name, *figures in zip(scene.outputs, before, after, own, strict=True):
        first, second, third = (float(figure.mean()) for figure in figures)
        print(f"{name:16}{first:10.2f}{second:10.2f}{third:12.2f}")
    print(f"mean bit-true errors at the {len(placements.codes)} placements, and as recorded\n")
    left = np.sqrt((after**2).mean(axis=1)) / recorded.error
    if left.max() > MOST_LEFT:
        warnings.warn(
            f"{scene.outputs[int(left.argmax())]} is off by {left.max():.1f} times as much as in "
            "the recording: gain and offset do not explain these placements",
            stacklevel=2,
        )


def _errors(scene: Scene, vectors: Vectors) -> Real:
    """Bit-true errors in percent, shape (outputs, rows)."""
    return vectors.percent_errors(SIGNAL.to_real(scene.twin().core.process(vectors.codes))).T


if __name__ == "__main__":
    sys.exit(run(main))
