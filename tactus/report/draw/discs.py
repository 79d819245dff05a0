"""What designs cost, for pictures of LUTs against clocks; among them the printed networks."""

from collections.abc import Sequence
from dataclasses import dataclass

from tactus.scene import load_scene, thesis_table

# The clocks of a scan of the thesis' front end, within which every network must finish.
SCAN_CLOCKS = 4096
# The networks of the digit that the thesis prints with their share of its device, and our scenes of
# the same hidden nodes, design and arithmetic.
PRINTED = {
    "cascade": ("digit.cascade_b", "digit-thesis"),
    "single": ("digit.hybrid", "digit-single-thesis"),
}


@dataclass(frozen=True)
class Disc:
    """A design in a picture.

    error: In per cent; 0 where the picture does not show it.
    """

    name: str
    luts: float
    multipliers: float
    clocks: float
    error: float = 0.0


def printed_discs() -> list[Disc]:
    """The networks that the thesis prints, at the clocks of ours of the same form.

    The thesis itself prints no time for a frame.
    """
    device, found = thesis_table("device"), []
    for name, (key, scene) in PRINTED.items():
        printed = thesis_table(key)
        luts = printed["luts_percent"] * device["luts4"] / 100
        multipliers = printed["mult18x18_percent"] * device["mult18x18"] / 100
        error = max(printed["simulation"])
        clocks = load_scene(scene).twin().output_clocks[-1]
        found.append(Disc(f"thesis, {name}", luts, multipliers, clocks, error))
    return found


def in_order(found: Sequence[Disc]) -> list[Disc]:
    """The design with the fewest LUTs first."""
    return sorted(found, key=lambda disc: (disc.luts, disc.clocks, disc.name))
