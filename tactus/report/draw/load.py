"""The load along the beam, as the hardware of a scene draws it and as it was recorded."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from golden.input_error import InputError
from golden.numbers.fixed import Codes
from golden.numbers.real import Real
from golden.visualisation.load_profile import RECTANGLE, TRIANGLE, LoadProfile, power_load
from tactus.report.draw.svg import PLOT_INCHES, style, svg
from tactus.scene import Scene
from tactus.scene.visualisation import RESULTS, VISUALISATION, Visualisation, visualisation

# The first recorded frames have the widest load. In this frame it is in the middle of the ramp.
FRAME = 4


@dataclass(frozen=True)
class Beam:
    """What the profile of a scene needs.

    shown: The section of the scene, or its defaults if there is none.
    frames, shape (frames, 4): The bit-true load, position, width and shape of every recorded frame.
    targets, shape (frames, 4): The recorded load, position, width and shape.
    sensors: shape (frames, sensors).
    mm: How many millimetres a coded position of 1 is.
    width_unit: How much a coded width of 1 is in the unit of the position.
    """

    shown: Visualisation
    frames: Codes
    targets: Real
    sensors: Real
    mm: float
    width_unit: float

    @property
    def profile(self) -> LoadProfile:
        return self.shown.load_profile

    @property
    def positions(self) -> Real:
        """The positions of the points that the hardware draws, in millimetres."""
        return self.mm * self.profile.fmt.to_real(self.profile.ramp.process())

    def drawn(self, frame: int) -> Real:
        """The bit-true profile of a frame, with one value for each point."""
        return self.profile.fmt.to_real(self.profile.process(self.frames[frame])[1])

    def exact(self, frame: int, millimetres: Real) -> Real:
        """Equation 3.18 in real arithmetic for the same outputs, at any positions."""
        load, centre, width, _ = self.profile.fmt.to_real(self.frames[frame])
        gain = self.profile.divider.gain / 2**self.profile.divider.gain_frac
        steepness = gain / max(width, self.profile.fmt.to_real(1))
        triangle = self.frames[frame, 3] > self.profile.shape_threshold
        power = TRIANGLE if triangle else RECTANGLE
        return power_load(millimetres / self.mm, load, centre, steepness, power)

    def check(self, frame: int, path: Path) -> None:
        """Refuse a frame that the vectors of the scene at ``path`` do not have."""
        if not 0 <= frame < len(self.frames):
            raise InputError(f"{path}: frame: got {frame}, expected 0 to {len(self.frames) - 1}")

    def true(self, frame: int) -> tuple[Real, Real]:
        """The corners of the recorded load: millimetres and heights."""
        load, centre, width, shape = self.targets[frame]
        half = width * self.width_unit / 2
        left, right = centre - half, centre + half
        if shape > self.profile.fmt.to_real(self.profile.shape_threshold):
            corners = [(left, 0.0), (centre, load), (right, 0.0)]
        else:
            corners = [(left, 0.0), (left, load), (right, load), (right, 0.0)]
        at, height = np.array(corners).T
        return self.mm * at, height


def has_load(scene: Scene) -> bool:
    """Whether a scene has all outputs for a profile of the load, and has them as signals."""
    return scene.visualisation is not None or (
        set(RESULTS) <= set(scene.outputs)
        and {"position", "width"} <= scene.length_mm.keys()
        and not scene.scale.keys() & set(RESULTS)
    )


def beam(scene: Scene) -> Beam:
    """The recorded frames of a scene and the outputs of its networks for them.

    scene: A scene for which ``has_load`` is true.
    """
    if not has_load(scene):
        raise InputError(
            f"{scene.path}: data.outputs: got {', '.join(scene.outputs)}, expected "
            f"{', '.join(RESULTS)} among them, with length_mm and without scale, or a section "
            "[visualisation], to draw the load"
        )
    shown = scene.visualisation
    if shown is None:
        data = {
            "sensors": list(scene.sensors),
            "outputs": list(scene.outputs),
            "scale": {},
            "length_mm": scene.length_mm,
            "full_scale": scene.full_scale,
        }
        values = {"data": data, "visualisation": VISUALISATION.filled({})}
        shown = visualisation(values, scene.path)
    assert shown is not None, "the section is there"
    vectors, results = scene.vectors(), list(shown.results)
    position, width = (
        scene.length_mm[name] / scene.full_scale[name]
        for name in (scene.outputs[shown.results[1]], scene.outputs[shown.results[2]])
    )
    return Beam(
        shown,
        scene.twin().core.process(vectors.codes)[:, results],
        vectors.targets[:, results],
        vectors.inputs,
        position,
        width / position,
    )


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
        return svg(figure, "profile", title)
