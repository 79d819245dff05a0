"""The motion of the swing and what the networks make of it, on a run they were not trained on."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from golden.physics.swing_data import RATE
from golden.precision import SIGNAL
from golden.scene import FOLDER, Scene
from golden.table import read_table
from tb.report.draw.drawing import identifier
from tb.report.draw.plot import plotted
from tb.report.draw.svg import PLOT_INCHES, style

RUN = FOLDER.parent / "data" / "swing-test-1.csv"
COORDINATES = ("x", "y", "z")
# A few swings: of more nobody could tell estimate and motion apart.
SECONDS = 10.0


def moves(scene: Scene) -> bool:
    """Whether a scene's outputs are the motion that ``swing`` draws, from signals."""
    return set(scene.outputs) == set(scene.length_mm) == set(COORDINATES) and not scene.scale


def swing(scene: Scene, run: Path = RUN) -> str:
    """True x, y and z against time, the bit-true estimates, and below each the difference.

    Parameters
    ----------
    scene : Scene
        One whose outputs are x, y and z, in any order, with their lengths in millimetres.
    run : Path
        A recording in the columns of the scene, at 200 samples per second.

    Returns
    -------
    str
        One ``<svg>`` element.

    Raises
    ------
    FileNotFoundError, ValueError
        See ``read_table`` and ``Scene.twin``; also for a scene of other outputs.
    """
    if not moves(scene):
        raise ValueError(
            f"{scene.path}: swing: got outputs {', '.join(scene.outputs)}, with lengths of "
            f"{', '.join(scene.length_mm) or 'none'}, expected x, y and z, and length_mm of each"
        )
    count = round(SECONDS * RATE)
    codes, _ = SIGNAL.quantise(read_table(run, scene.sensors)[:count], str(run))
    actual = read_table(run, scene.outputs)[:count]
    found = SIGNAL.to_real(scene.twin().process(codes))
    time = np.arange(len(codes)) / RATE
    with style():
        figure = Figure(figsize=(PLOT_INCHES[0], 2.4 * PLOT_INCHES[1]), layout="constrained")
        rows = figure.subplots(6, 1, sharex=True, height_ratios=[2, 1] * 3)
        for name, trace, error in zip(COORDINATES, rows[::2], rows[1::2], strict=True):
            column = scene.outputs.index(name)
            mm = scene.length_mm[name] / scene.full_scale[name]
            true, estimate = mm * actual[:, column], mm * found[:, column]
            trace.plot(time, true, color="0.6", linewidth=2.4, label="true")
            trace.plot(time, estimate, color="k", linewidth=0.7, label="bit-true estimate")
            trace.set_ylabel(f"{name}, mm")
            error.plot(time, estimate - true, color="C3", linewidth=0.7)
            error.set_ylabel("error, mm")
        figure.align_ylabels()
        rows[0].legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
        rows[-1].set_xlabel(f"time since release in {run.stem}, s; x, y, z count from code 0")
        title = f"Motion of the swing in {run.stem} and the estimates of scene {scene.name}"
        return plotted(figure, identifier("swing", scene.name), title)
