"""The colour and the marker of each group of points in a plot.

On a screen the colours differ, and in print without colour the markers do.
"""

from dataclasses import dataclass

COLOURS = (
    *("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9"),
    *("#e69f00", "#000000", "#999999", "#8c510a", "#762a83"),
)
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "d", "<", ">")


@dataclass(frozen=True)
class Look:
    """The colour and the marker of a group, and whether the marker is filled."""

    colour: str
    marker: str
    filled: bool = True


def nth(index: int) -> Look:
    """The look of the group ``index`` of a plot."""
    return Look(COLOURS[index % len(COLOURS)], MARKERS[index % len(MARKERS)])
