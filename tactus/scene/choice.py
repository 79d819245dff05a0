"""The design that is chosen for a scene, and the designs that it is chosen from."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from golden.input_error import InputError, naming
from golden.networks.engine import Engine
from golden.networks.network import Network
from tactus.sizing.candidates import CANDIDATES, Refused, Sized, SizingTask, all_sized, settings_for
from tactus.sizing.choice import Choice, choose

if TYPE_CHECKING:
    from tactus.scene.scene import Scene


def task_of(scene: Scene) -> SizingTask:
    """The networks of a scene, its settings and its recorded frames."""
    around = {
        "a section [front_end]": scene.front_end is not None,
        "a section [visualisation]": scene.visualisation is not None,
        "hardware.interface 'axi_stream'": scene.interface == "axi_stream",
        "data.window with past samples": not scene.window.plain,
    }
    codes = scene.vectors().codes
    inputs = scene.members[0].inputs
    with naming(scene.path):
        return SizingTask(
            scene.arrangement,
            scene.networks(),
            scene.settings(),
            scene.design,
            tuple(name for name, there in around.items() if there),
            scene.argmax,
            np.asarray(codes)[:, :inputs],
            scene.front_end is None and scene.visualisation is None,
            scene.demand.interval,
        )


def compared(scene: Scene) -> tuple[list[Sized], list[Refused]]:
    """Every design of a scene with its costs, and those that cannot be built."""
    task = task_of(scene)
    found = all_sized(task, CANDIDATES)
    return (
        [one for one in found if isinstance(one, Sized)],
        [one for one in found if isinstance(one, Refused)],
    )


def choice_of(scene: Scene) -> Choice:
    """The design that is chosen for a scene whose design is "auto"."""
    wanted, task = scene.demand, task_of(scene)
    if scene.front_end and not wanted.clocks:
        wanted = replace(wanted, clocks=scene.front_end.clocks_left(scene.window))
    with naming(scene.path):
        return choose(task, wanted, scene.price)


def chosen(scene: Scene, choice: Choice) -> Scene:
    """The scene as it would be if it named the design that is chosen."""
    settings = settings_for(task_of(scene), choice.row.candidate)
    options = dict(settings.options)
    if choice.row.candidate.design == Engine.block and choice.demand.clocks:
        options["clocks"] = choice.demand.clocks
    return replace(
        scene,
        design=choice.row.candidate.design,
        design_options=options,
        activation=settings.activation,
        activation_options=dict(settings.activation_options),
    )


def check_demand(scene: Scene, network: Network, framed: Network) -> None:
    """Refuse a design that is slower than the scene demands, or whose frames must not overlap.

    network: The networks alone, whose clocks count.
    framed: The same behind the memory of past samples, if there is one, which may take longer from
        frame to frame.
    """
    around = {
        "a section [front_end]": scene.front_end is not None,
        "a section [visualisation]": scene.visualisation is not None,
    }
    named = next((name for name, there in around.items() if there), "")
    with naming(scene.path):
        if named and isinstance(network, Engine) and network.loops:
            raise InputError(
                f"hardware.interval: got {scene.demand.interval}, for which frames overlap in "
                f"'engine', with {named}, expected more clocks, or no such section"
            )
        scene.demand.refuse(network, f"design {scene.design}")
        replace(scene.demand, clocks=0).refuse(framed, f"design {scene.design}")
