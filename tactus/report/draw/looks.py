"""The look of groups of points, so that an activation or a design looks alike in every plot.

An activation has a colour, and also a marker if a plot does not distinguish designs. A design has a
marker for each of its arrangements. Hollow markers show ``thesis`` precision. On a screen the
colours differ, and in print without colour the markers do.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from golden.activation.schemes import forms
from golden.networks.designs import DESIGNS
from golden.networks.engine import Engine
from golden.networks.lanes import Lanes
from golden.numbers.precision import THESIS

COLOURS = (
    *("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9"),
    *("#e69f00", "#000000", "#999999", "#8c510a", "#762a83"),
)
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "d", "<", ">")
# No marker is used both for an activation and for a design.
ACTIVATION_MARKERS = ("v", "P", "X", "d", "<", ">", "p", "1", "2", "3")
DESIGN_MARKERS = ("o", "^", "s", "D", "*", "h", "8", "H", "+", "x")


@dataclass(frozen=True)
class Look:
    """The colour and the marker of a group, and whether the marker is filled."""

    colour: str
    marker: str
    filled: bool = True


def nth(index: int) -> Look:
    """The look of the group ``index`` among groups that are neither activations nor designs."""
    return Look(COLOURS[index % len(COLOURS)], MARKERS[index % len(MARKERS)])


def activation_look(form: str, precision: str) -> Look:
    """The look of an activation, by the name of its form in ``schemes.forms``."""
    place = _place(form, list(forms()))
    marker = ACTIVATION_MARKERS[place % len(ACTIVATION_MARKERS)]
    return Look(nth(place).colour, marker, precision != THESIS.name)


def network_look(design: str, arrangement: str, form: str, precision: str) -> Look:
    """The look of a network: the colour of its activation, the marker of design and arrangement.

    An engine looks the same with one multiplier and with several.
    """
    names = [name for name in DESIGNS if name != Lanes.block]
    known = [f"{name}, {other}" for name in names for other in DESIGNS[name].arrangements]
    shown = Engine.block if design == Lanes.block else design
    place = _place(f"{shown}, {arrangement}", known)
    marker = DESIGN_MARKERS[place % len(DESIGN_MARKERS)]
    return Look(activation_look(form, precision).colour, marker, precision != THESIS.name)


def _place(name: str, known: Sequence[str]) -> int:
    if name not in known:
        raise ValueError(f"plot: got {name!r}, expected one of {', '.join(known)}")
    return known.index(name)
