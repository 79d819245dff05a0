"""What networks of four outputs cost, ours and the printed ones: clocks, errors, LUTs."""

from collections.abc import Sequence
from dataclasses import dataclass

from tactus.errors import scene_errors
from tactus.report.draw.named import Named, drawn, front
from tactus.report.measure.networks import FAMILY, scenes
from tactus.scene import FOLDER, load_scene, thesis_table
from tactus.synth.budget import is_recorded, read_budget

# The clocks of a scan of the thesis' front end, within which every network must finish.
SCAN_CLOCKS = 4096
# The networks of the digit that the thesis prints with their share of its device, and our scenes of
# the same hidden nodes, design and arithmetic.
PRINTED = {
    "cascade": ("digit.cascade_b", "digit-thesis"),
    "single": ("digit.hybrid", "digit-single-thesis"),
}
ACROSS = "clocks from the last sample to the last output"


@dataclass(frozen=True)
class Design:
    """A network of four outputs.

    error: The largest mean error at a position, of the worst output, in per cent.
    """

    name: str
    luts: float
    clocks: float
    error: float


def measured() -> list[Design]:
    """The networks of four outputs that finish within a scan and have recorded cells.

    Instruments are left out, because they wait for their scan.
    """
    found = []
    for scene in scenes():
        four = len(scene.outputs) == 4 and scene.data_paths == (FOLDER / "data" / "appendix2.csv",)
        if not four or not is_recorded(scene.path) or scene.twin().interval >= SCAN_CLOCKS:
            continue
        design = scene.twin()
        found.append(
            Design(
                scene.name.removeprefix("comparison/"),
                read_budget(scene.path)[FAMILY][design.entity]["LUT"],
                design.clocks_after_samples,
                max(error.largest_mean for error in scene_errors(scene)["bit-true"]),
            )
        )
    return found


def printed_designs() -> list[Design]:
    """The networks that the thesis prints, at the clocks of ours of the same form.

    The thesis itself prints no time for a frame.
    """
    device, found = thesis_table("device"), []
    for name, (key, scene) in PRINTED.items():
        printed = thesis_table(key)
        luts = printed["luts_percent"] * device["luts4"] / 100
        clocks = load_scene(scene).twin().clocks_after_samples
        found.append(Design(f"thesis, {name}, printed", luts, clocks, max(printed["simulation"])))
    return found


def _shown(found: Sequence[Design]) -> list[Design]:
    """Those networks and the printed ones, the one with the fewest LUTs first."""
    every = [*found, *printed_designs()]
    return sorted(every, key=lambda one: (one.luts, one.clocks, one.name))


def area(found: Sequence[Design]) -> str:
    """Clocks against LUTs. Each name tells the error too."""
    points = [Named(f"{d.name}, {d.error:.2f} %", d.clocks, d.luts) for d in _shown(found)]
    title = "The same four outputs: area against clocks, and the error of the worst output"
    return _picture(points, "area", title, ACROSS, "Virtex-II LUTs, entity by entity")


def networks(found: Sequence[Design]) -> str:
    """Clocks against the error of the worst output."""
    points = [Named(one.name, one.clocks, one.error) for one in _shown(found)]
    clock = float(thesis_table("board")["clock_mhz"])
    across = f"{ACROSS}; {clock:g} are 1 µs for the thesis"
    title = "The same four outputs: error against clocks"
    return _picture(points, "networks", title, across, "error of the worst output, %")


def _picture(points: list[Named], name: str, title: str, across: str, up: str) -> str:
    best = ", ".join(one.name for one in front(points))
    return drawn(points, name, title, across, up, f"Not beaten on both axes: {best}.")
