"""Draws the load profile of one recorded frame."""

import numpy as np
from matplotlib.figure import Figure

from tactus.report.draw.drawing import identifier
from tactus.report.draw.load import FRAME, beam
from tactus.report.draw.svg import PLOT_INCHES, plotted, style
from tactus.scene import Scene

POINTS = 400


def profile(scene: Scene, frame: int = FRAME) -> str:
    """The bit-true profile, equation 3.18 in real arithmetic, and the recorded load.

    scene: A scene with load, position, width and shape among its outputs. If it has no section
        ``[visualisation]``, the defaults are used.
    frame: Row of the scene's recorded vectors.

    Returns: One ``<svg>`` element.
    """
    known = beam(scene)
    known.check(frame, scene.path)
    at, height = known.true(frame)
    left = min(known.positions[0], at[0])
    right = max(known.positions[-1], at[-1])
    fine = np.linspace(left, right, POINTS)
    with style():
        figure = Figure(figsize=PLOT_INCHES, layout="constrained")
        axes = figure.add_subplot()
        ends = np.array([left]), np.array([right])
        axes.plot(
            np.concatenate([ends[0], at, ends[1]]),
            np.concatenate([[0.0], height, [0.0]]),
            color="0.45",
            linewidth=0.8,
            label="recorded load",
        )
        axes.plot(fine, known.exact(frame, fine), color="C0", label="equation 3.18, real")
        axes.plot(
            known.positions, known.drawn(frame), "o", color="k", label="equation 3.18, bit-true"
        )
        axes.set_xlabel("position along the beam, mm")
        axes.set_ylabel("load, coded")
        axes.set_ylim(bottom=min(0.0, float(known.drawn(frame).min())) - 0.02)
        axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
        title = f"Load profile of recorded frame {frame} of scene {scene.name}"
        return plotted(figure, identifier("profile", scene.name), title)
