"""The load along the beam, as the hardware of a scene draws it and as it was recorded."""

from collections.abc import Mapping
from dataclasses import replace

from matplotlib.figure import Figure

from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from tactus.report.draw.svg import PLOT_INCHES, style, svg
from tactus.scene import Scene

# The first recorded frames have the widest load. In this frame it is in the middle of the ramp.
FRAME = 4
# The steps of a curve for each point that the hardware draws, and the width of a panel in inches.
FINE, PANEL = 16, 2.2

Curve = tuple[Real, Real]


def drawn(scene: Scene, frame: int) -> tuple[Curve, Curve]:
    """Positions in mm and heights that the hardware draws, and those of the recorded load.

    The latter is equation 3.18 in real arithmetic, for the targets of the frame.
    """
    shown = scene.visualisation
    assert shown is not None, "only such a scene is drawn"
    vectors, results, profile = scene.vectors(), list(shown.results), shown.load_profile
    position = scene.outputs[shown.results[1]]
    mm = scene.length_mm[position] / scene.full_scale[position]
    codes = scene.twin().core.process(vectors.codes[[frame]])[0, results]
    points = 1 + FINE * (profile.ramp.points - 1)
    ramp = replace(profile.ramp, step=profile.ramp.step // FINE, points=points)
    targets, _ = SIGNAL.quantise(vectors.targets[frame, results])
    at, height = map(SIGNAL.to_real, profile.process(codes))
    return (mm * at, height), (
        mm * SIGNAL.to_real(ramp.process()),
        replace(profile, ramp=ramp).real(targets),
    )


def load_profile(scene: Scene, frames: Mapping[str, int] | None = None) -> str:
    """A panel for each frame of a scene with a section ``[visualisation]``, by its title."""
    wide, high = PLOT_INCHES
    number = min(FRAME, len(scene.vectors().codes) - 1)
    frames = frames or {f"recorded frame {number}": number}
    with style():
        figure = Figure(figsize=(max(wide, PANEL * len(frames)), high), layout="constrained")
        panels = figure.subplots(1, len(frames), sharey=True, squeeze=False)[0]
        for axes, (title, frame) in zip(panels, frames.items(), strict=True):
            points, curve = drawn(scene, frame)
            axes.plot(*curve, label="equation 3.18, recorded load")
            axes.plot(*points, "o", label="hardware, bit-true")
            axes.set_title(title, fontsize="medium")
            axes.set_xlabel("along the beam, mm")
        panels[0].set_ylabel("load, coded")
        labelled = panels[0].get_legend_handles_labels()
        figure.legend(*labelled, loc="outside lower center", ncols=2)
        told = f"Load profiles of scene {scene.name}: {', '.join(frames)}"
        return svg(figure, "profile", told, narrowest=560 if len(frames) > 1 else 0)
