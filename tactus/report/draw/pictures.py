"""The pictures of a scene, and the reasons why some are not drawn."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from golden.common.block import walk
from golden.networks.table_sums import learned
from tactus.report.draw.datapath import datapath
from tactus.report.draw.learned import learned_curves
from tactus.report.draw.load import has_load, load_profile
from tactus.report.draw.network import network
from tactus.report.draw.svg import Picture
from tactus.report.draw.waveforms import waveforms
from tactus.report.measure.simulated_frame import simulate_frame
from tactus.scene import Scene
from tactus.scene.front_end import RESULTS


@dataclass(frozen=True)
class Skipped:
    title: str
    why: str


def draw(scene: Scene) -> dict[str, list[Any]]:
    """The drawn pictures, and title and reason of the others, as the store holds them."""
    found = list(pictures(scene))
    return {
        "drawn": [vars(part) for part in found if isinstance(part, Picture)],
        "skipped": [(part.title, part.why) for part in found if isinstance(part, Skipped)],
    }


def pictures(scene: Scene) -> Iterator[Picture | Skipped]:
    """Every picture that can be drawn of the scene, and those that cannot."""
    design = scene.twin()
    blocks = list(walk(design))
    hidden = sum(sum(network.shape[1:-1]) for network in scene.networks())
    nodes = network(scene)
    yield Picture(
        "network",
        "Networks",
        nodes,
        f"{hidden} hidden nodes in all; drawn from the weights that the hardware holds.",
        wide="min-width" in nodes,
    )
    if all(map(learned, scene.networks())):
        yield Picture(
            "functions",
            "Learned functions",
            learned_curves(scene),
            "Each function over the range that its input has on the recorded rows, without its "
            "mean. Blue ones are curved and take a table, grey ones are straight.",
            wide=True,
        )
    yield Picture(
        "datapath",
        "Datapath",
        datapath(scene),
        f"{len(blocks)} entities, drawn from the design that is exported.",
        wide=True,
    )
    title = "One recorded frame, clock by clock"
    if design.stream == "axi_stream":
        yield Skipped(title, "its stream may pause at any clock")
    elif design.stream not in ("serial", "words"):
        yield Skipped(title, f"a scan takes {design.interval} clocks")
    else:
        text = (
            "The exported Verilog in Icarus; the first recorded frame, codes as real values. In a "
            "long frame, clocks in which nothing comes or goes are left out."
        )
        drawn = waveforms(simulate_frame(scene), f"{scene.name}: {title[0].lower()}{title[1:]}")
        yield Picture("waveforms", title, drawn, text, wide=True)
    if has_load(scene):
        yield Picture(
            "load_profile",
            "Load profile of a recorded frame",
            load_profile(scene),
            "As the hardware computes it, beside equation 3.18 in real arithmetic for the same "
            "outputs, and the load that was recorded.",
        )
    else:
        yield Skipped("Load profile", f"it needs outputs {', '.join(RESULTS)} with lengths")
