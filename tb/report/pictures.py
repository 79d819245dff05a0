"""The pictures of a scene, and which of them it has no use for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from golden.block import walk
from golden.instruments.instrument import Instrument
from golden.report.page import Picture
from golden.report.pictures.animation import animation
from golden.report.pictures.datapath import datapath
from golden.report.pictures.load import has_load
from golden.report.pictures.network import network
from golden.report.pictures.profile import profile
from golden.report.pictures.swing import COORDINATES, moves, swing
from golden.report.pictures.waveforms import waveforms
from golden.scene import Scene
from golden.visualisation.section import RESULTS
from hdl.common.lookup import latency
from tb.common.recording import record


@dataclass(frozen=True)
class Skipped:
    """A picture that is not drawn, and why."""

    title: str
    why: str


def draw(scene: Scene) -> dict[str, list[Any]]:
    """The pictures as the store holds them: those drawn, and title and reason of the others."""
    found = list(pictures(scene))
    return {
        "drawn": [vars(part) for part in found if isinstance(part, Picture)],
        "skipped": [(part.title, part.why) for part in found if isinstance(part, Skipped)],
    }


def pictures(scene: Scene) -> Iterator[Picture | Skipped]:
    """Everything that can be drawn of the scene."""
    design = scene.design()
    blocks = list(walk(design))
    hidden = sum(mlp.shape[1] for mlp in scene.mlps())
    yield Picture(
        "network",
        "Networks",
        network(scene),
        f"{hidden} hidden nodes in all; drawn from the weights that the hardware holds.",
    )
    yield Picture(
        "datapath",
        "Datapath",
        datapath(scene, {block.entity: latency(block) for block in blocks}),
        f"{len(blocks)} entities, drawn from the design that is exported.",
        wide=True,
    )
    title = "One recorded frame, clock by clock"
    if isinstance(design, Instrument):
        yield Skipped(title, f"a scan takes {design.interval} clocks")
    elif scene.interface == "axi_stream":
        yield Skipped(title, "its stream may pause at any clock")
    else:
        text = "The exported Verilog in Icarus; the first recorded frame, codes as real values."
        drawn = waveforms(record(scene), f"{scene.name}: {title[0].lower()}{title[1:]}")
        yield Picture("waveforms", title, drawn, text, wide=True)
    if has_load(scene):
        yield Picture(
            "load_profile",
            "Load profile of a recorded frame",
            profile(scene),
            "As the hardware computes it, beside equation 3.18 in real arithmetic for the same "
            "outputs, and the load that was recorded.",
        )
        yield Picture(
            "load_moves",
            "A recorded load along the beam",
            animation(scene),
            "Each step is a recorded frame: what the sensors read, and the bit-true profile.",
        )
    else:
        yield Skipped("Load profile", f"it needs the outputs {', '.join(RESULTS)}")
    if moves(scene):
        yield Picture(
            "motion",
            "Motion of the swing and its estimates",
            swing(scene),
            "A run that the networks were not trained on: the motion, the bit-true estimate, and "
            "below each the difference.",
            wide=True,
        )
    else:
        yield Skipped("Motion", f"it needs the outputs {', '.join(COORDINATES)} with lengths")
