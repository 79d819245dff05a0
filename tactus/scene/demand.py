"""How fast a scene's networks must be, and the design that is chosen for it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from golden.input_error import InputError, naming
from golden.networks.engine import Engine
from golden.networks.lanes import Lanes
from golden.networks.network import Network
from tactus.core.schema import written
from tactus.scene.comparison import task_of
from tactus.sizing.candidates import settings_for
from tactus.sizing.choice import UNDECIDED, Choice, Demand, choose
from tactus.sizing.price import DEFAULT, DEVICES, Price, shares_of

if TYPE_CHECKING:
    from tactus.scene.scene import Scene


def demand(hardware: dict[str, Any], path: Path) -> Demand:
    """The limits of a section ``[hardware]``."""
    rate, interval = hardware["frames_a_second"], hardware["interval"]
    if rate:
        if interval:
            raise InputError(
                f"{path}: hardware.frames_a_second: got {rate:g} with interval {interval}, "
                "expected one of the two"
            )
        interval = int(1e6 * hardware["clock_mhz"] / rate)
        if interval < 1:
            raise InputError(
                f"{path}: hardware.frames_a_second: got {rate:g}, expected at most "
                f"{1e6 * hardware['clock_mhz']:g}, a frame in every clock"
            )
    return Demand(hardware["clocks"], interval, rate)


def price(hardware: dict[str, Any], path: Path) -> Price:
    """The prices of a section ``[hardware]``."""
    for key in ("device", "prices"):
        if hardware.get(key) and hardware["design"] != UNDECIDED:
            raise InputError(
                f"{path}: hardware.{key}: got {written(hardware[key])} with design "
                f"{hardware['design']!r}, expected design {UNDECIDED!r}"
            )
    found, prices = shares_of(hardware["device"] or DEFAULT), hardware.get("prices")
    if prices is None:
        return found
    if not any(prices.values()):
        raise InputError(f"{path}: hardware.prices: got 0 for all, expected one above 0")
    return Price(DEVICES[found.device.name], **prices, shares=False)


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
        if named and isinstance(network, Lanes) and network.loops:
            raise InputError(
                f"hardware.interval: got {scene.demand.interval}, for which frames overlap in "
                f"'lanes', with {named}, expected more clocks, or no such section"
            )
        scene.demand.refuse(network, f"design {scene.design}")
        replace(scene.demand, clocks=0).refuse(framed, f"design {scene.design}")
