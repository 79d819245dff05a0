"""The load along the beam, as the hardware of a scene draws it and as it was recorded."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from golden.numbers.real import Real
from golden.visualisation.load_profile import RECTANGLE, TRIANGLE, power_load
from tactus.report.draw.svg import PLOT_INCHES, style, svg
from tactus.scene import Scene

# The first recorded frames have the widest load. In this frame it is in the middle of the ramp.
FRAME = 4
POINTS = 400


@dataclass(frozen=True)
class Drawn:
    """A recorded frame as the hardware draws it, and as it was recorded; positions are in mm.

    points: The positions and heights of the points that the hardware draws.
    exact: Equation 3.18 in real arithmetic for the same outputs, at any positions.
    true: The positions and heights of the corners of the recorded load.
    """

    points: tuple[Real, Real]
    exact: Callable[[Real], Real]
    true: tuple[Real, Real]


def drawn(scene: Scene, frame: int) -> Drawn:
    shown = scene.visualisation
    assert shown is not None, "only such a scene is drawn"
    vectors, results = scene.vectors(), list(shown.results)
    # What a coded position and a coded width of 1 are.
    mm, wide = (
        scene.length_mm[name] / scene.full_scale[name]
        for name in (scene.outputs[shown.results[1]], scene.outputs[shown.results[2]])
    )
    profile = shown.load_profile
    real = profile.fmt.to_real
    codes = scene.twin().core.process(vectors.codes[[frame]])[0, results]
    load, centre, width, _ = real(codes)
    steepness = profile.divider.gain / 2**profile.divider.gain_frac / max(width, real(1))
    power = TRIANGLE if codes[3] > profile.shape_threshold else RECTANGLE
    height, middle, width, shape = vectors.targets[frame, results]
    left, right = mm * middle - wide * width / 2, mm * middle + wide * width / 2
    corners = [(left, 0.0), (left, height), (right, height), (right, 0.0)]
    if shape > real(profile.shape_threshold):
        corners[1:3] = [(mm * middle, height)]
    at, heights = np.array(corners).T
    return Drawn(
        (mm * real(profile.ramp.process()), real(profile.process(codes)[1])),
        lambda millimetres: power_load(millimetres / mm, load, centre, steepness, power),
        (at, heights),
    )


def load_profile(scene: Scene) -> str:
    """The bit-true profile, equation 3.18 in real arithmetic, and the recorded load.

    scene: One with a section ``[visualisation]``.

    Returns: One ``<svg>`` element.
    """
    frame = min(FRAME, len(scene.vectors().codes) - 1)
    known = drawn(scene, frame)
    (positions, heights), (at, height) = known.points, known.true
    left, right = min(positions[0], at[0]), max(positions[-1], at[-1])
    fine = np.linspace(left, right, POINTS)
    with style():
        figure = Figure(figsize=PLOT_INCHES, layout="constrained")
        axes = figure.add_subplot()
        axes.plot(
            np.concatenate([[left], at, [right]]),
            np.concatenate([[0.0], height, [0.0]]),
            color="0.45",
            linewidth=0.8,
            label="recorded load",
        )
        axes.plot(fine, known.exact(fine), color="C0", label="equation 3.18, real")
        axes.plot(positions, heights, "o", color="k", label="equation 3.18, bit-true")
        axes.set_xlabel("position along the beam, mm")
        axes.set_ylabel("load, coded")
        axes.set_ylim(bottom=min(0.0, float(heights.min())) - 0.02)
        axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
        title = f"Load profile of recorded frame {frame} of scene {scene.name}"
        return svg(figure, "profile", title)
