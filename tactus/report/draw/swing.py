"""Draws the motion of the swing and the estimates of the networks, on an independent run."""

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from golden.input_error import InputError
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from tactus.physics.swing_data import RATE, independent_run
from tactus.report.draw.svg import PLOT_INCHES, style, svg
from tactus.scene import Scene, load_scene

# The run that is drawn.
RUN = 1
NAME = f"swing-test-{RUN}"
COORDINATES = ("x", "y", "z")
# A few swings. With more of them, estimate and motion could not be distinguished.
SECONDS = 10.0
WITHOUT, WITH = "without past samples", "with past samples"


def moves(scene: Scene) -> bool:
    """Whether the outputs of a scene are the motion that ``swing`` draws, as signals."""
    return set(scene.outputs) == set(scene.length_mm) == set(COORDINATES) and not scene.scale


@dataclass(frozen=True)
class Followed:
    """A stretch of a run and the estimates of a scene's hardware, in millimetres from code 0.

    time, shape (frames,): The seconds since release.
    true, estimate, shape (frames, 3): x, y and z.
    """

    time: Real
    true: Real
    estimate: Real


def follow(scene: Scene, run: int, seconds: float) -> Followed:
    """The estimates of a scene's hardware for the first seconds of a run."""
    count, past = round(seconds * RATE), scene.window.past
    codes, _ = SIGNAL.quantise(independent_run(run, scene.sensors)[:count])
    actual = independent_run(run, scene.outputs)[past:count]
    found = SIGNAL.to_real(scene.twin().core.process(scene.window.frames(codes)))
    at = [scene.outputs.index(name) for name in COORDINATES]
    mm = np.array([scene.length_mm[name] / scene.full_scale[name] for name in COORDINATES])
    return Followed(np.arange(past, count) / RATE, mm * actual[:, at], mm * found[:, at])


def without_past(scene: Scene) -> Scene | None:
    """The shipped scene of the same arrangement without past samples; none if this is one."""
    return None if scene.window.plain else load_scene(f"swing-{scene.arrangement}")


def swing(scene: Scene) -> str:
    """The true x, y and z against time, the bit-true estimates, and the difference below each.

    For a scene with past samples, the difference of the scene without them is drawn too.

    scene: A scene whose outputs are x, y and z, in any order, with their lengths in millimetres.

    Returns: One ``<svg>`` element.
    """
    if not moves(scene):
        raise InputError(
            f"{scene.path}: swing: got outputs {', '.join(scene.outputs)}, with lengths of "
            f"{', '.join(scene.length_mm) or 'none'}, expected x, y and z, and length_mm of each"
        )
    found, other = follow(scene, RUN, SECONDS), without_past(scene)
    before = None if other is None else follow(other, RUN, SECONDS)
    with style():
        figure = Figure(figsize=(PLOT_INCHES[0], 2.4 * PLOT_INCHES[1]), layout="constrained")
        rows = figure.subplots(6, 1, sharex=True, height_ratios=[2, 1] * 3)
        columns = zip(COORDINATES, found.true.T, found.estimate.T, strict=True)
        for n, (name, true, estimate) in enumerate(columns):
            trace, error = rows[2 * n : 2 * n + 2]
            trace.plot(found.time, true, color="0.6", linewidth=2.4, label="true")
            trace.plot(found.time, estimate, color="k", linewidth=0.7, label="bit-true estimate")
            trace.set_ylabel(f"{name}, mm")
            if before is not None:
                missed = before.estimate[:, n] - before.true[:, n]
                error.plot(before.time, missed, color="C0", linewidth=0.5, label=WITHOUT)
            error.plot(found.time, estimate - true, color="C3", linewidth=0.7, label=WITH)
            error.set_ylabel("error, mm")
        figure.align_ylabels()
        lines = [line for axis in rows[: 2 if before else 1] for line in axis.lines]
        rows[0].legend(handles=lines, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
        rows[-1].set_xlabel(f"time since release in {NAME}, s; x, y, z count from code 0")
        title = f"Motion of the swing in {NAME} and the estimates of scene {scene.name}"
        return svg(figure, "swing", title)
