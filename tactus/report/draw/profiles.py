"""Draws the functions of section 3.13, and what the power-folding unit makes of recorded loads."""

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from golden.common.block import walk
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from golden.visualisation.functions import harmonic_load, power_load
from golden.visualisation.load_profile import RECTANGLE, LoadProfile
from tactus.report.draw.looks import nth
from tactus.report.draw.plot import plotted
from tactus.report.draw.svg import PAGE_INCHES, style
from tactus.scene import load_scene, thesis_table

SCENE = "thesis"
# The recorded position that is nearest to the 0.5 of Figures 5.26 to 5.29.
POSITION = 0.495
# Points of a curve: enough to show the waves of a thousand terms as a band.
POINTS = 1501


@dataclass(frozen=True)
class Shown:
    """The profile that the hardware draws for one recorded load.

    load: Its letter in Table 3.1.
    x, y, shape (points,): What the unit gives, behind the networks.
    target, shape (fine points,): Equation 3.18 for the recorded load itself, at ``fine``.
    largest: The largest difference of the points from equation 3.18 at the networks' outputs, in
        units of 2^-13.
    """

    load: str
    x: Real
    y: Real
    fine: Real
    target: Real
    largest: float


def unit() -> list[Shown]:
    """The loads of Figures 5.26 to 5.29, through the networks and the unit of the thesis."""
    scene = load_scene(SCENE)
    (block,) = (part for part in walk(scene.twin()) if isinstance(part, LoadProfile))
    vectors = scene.vectors()
    loads = thesis_table("loads")
    found = []
    for name in thesis_table("load_function")["shown"]:
        load, width, shape = loads[name]
        wanted = [load, POSITION, width, shape]
        row = int(np.argmin(np.abs(vectors.targets - wanted).sum(axis=1)))
        outputs: Codes = np.asarray(scene.twin().core.process(vectors.codes[[row]]))
        x, y = block.process(outputs)
        real = block.real(outputs)
        target = vectors.targets[row]
        fine = np.linspace(0, 0.8, 321)
        power = 2 if SIGNAL.quantise(target[3])[0] > block.shape_threshold else RECTANGLE
        gain = block.divider.gain / 2**block.divider.gain_frac
        found.append(
            Shown(
                name,
                SIGNAL.to_real(x),
                SIGNAL.to_real(y[0]),
                fine,
                power_load(fine, target[0], target[1], gain / target[2], power),
                float(np.abs(y[0] - real[0] * 2**SIGNAL.frac).max()),
            )
        )
    return found


def unit_drawn(found: list[Shown]) -> str:
    """Markers for the points of the unit, and lines for the loads that were placed."""
    with style():
        figure = Figure(figsize=PAGE_INCHES, layout="constrained")
        for axes, one in zip(figure.subplots(1, len(found), sharey=True), found, strict=True):
            axes.plot(one.fine, one.target, color=nth(0).colour, label="equation 3.18, load placed")
            axes.plot(one.x, one.y, "o", color=nth(1).colour, label="power-folding unit")
            axes.set_title(f"load {one.load}", fontsize=10)
            axes.set_xlabel("position, 0.9 at 127 mm")
        figure.axes[0].set_ylabel("load, coded")
        handles, labels = figure.axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=2)
        return plotted(figure, "profiles", "Profiles of loads C, B, A and H, from recorded samples")


def unit_sentence(found: list[Shown]) -> str:
    """How far the unit is from its equation."""
    most = max(one.largest for one in found)
    return (
        f"Recorded samples at position {POSITION} go through the networks of scene `{SCENE}` and "
        f"then through the unit, bit-true. The unit itself errs by at most {most:.1f} units of "
        "2^-13; the rest of the difference is the error of the networks."
    )


def functions_drawn() -> str:
    """Equation 3.17 as in Figure 3.27, and equation 3.18 for the same loads."""
    cases = thesis_table("load_function")["cases"]
    x = np.linspace(0, 1, POINTS)
    with style():
        figure = Figure(figsize=PAGE_INCHES, layout="constrained")
        left, right = figure.subplots(1, 2)
        for i, (name, (load, centre, half_width, terms)) in enumerate(cases.items()):
            label = f"{name}: d {load:g}, w {half_width:g}, P {terms}"
            y = harmonic_load(x, load, centre, half_width, terms)
            left.plot(x, y, color=nth(i).colour, label=label)
        for i, power in enumerate((2, RECTANGLE)):
            label = f"d 0.5, C {1 / 0.3:.2f}, P {power}"
            y = power_load(x, 0.5, 0.5, 1 / 0.3, power)
            right.plot(x, y, color=nth(i).colour, label=label)
        for axes, title in ((left, "equation 3.17, Figure 3.27"), (right, "equation 3.18")):
            axes.set_title(title, fontsize=10)
            axes.set_xlabel("position")
            axes.legend()
        left.set_ylabel("f")
        return plotted(figure, "functions", "The functions of section 3.13 along the beam")


def functions_sentence() -> str:
    """What the left side shows."""
    load, centre, half_width, _ = thesis_table("load_function")["cases"]["A"]
    foot = float(harmonic_load(0.0, load, centre, half_width, 100_000))
    return (
        "Equation 3.17 has no constant term: beside case A it is at "
        f"{foot:.2f} instead of 0, and with ten terms (B) its edges are waves. The parameters of "
        "Figure 3.28 are not printed, so the right side has those of case A."
    )
