"""Chooses a design where a scene names none, and builds the bit-true twin of its hardware."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from golden.input_error import InputError, naming
from golden.instruments.converter_instrument import ConverterInstrument
from golden.instruments.instrument import Instrument
from golden.instruments.readout import Readout
from golden.instruments.uart_instrument import UartInstrument
from golden.learning.corrected import Corrected
from golden.learning.gradient import constants
from golden.networks.arrangement import arrange
from golden.networks.axis_network import AxisNetwork
from golden.networks.constants import constants_of
from golden.networks.design import AtOnce
from golden.networks.designs import DESIGNS
from golden.networks.engine import Engine
from golden.networks.learning_engine import LearningEngine
from golden.networks.network import Network
from golden.networks.windowed import Windowed
from golden.numbers.precision import SIGNAL
from tactus.scene.disturbance import expected_drift
from tactus.sizing.candidates import Refused, Sized, SizingTask, all_sized, settings_for
from tactus.sizing.choice import Choice, choose

if TYPE_CHECKING:
    from tactus.scene.scene import Scene


def build_twin(scene: Scene, lean: bool) -> Network:
    """Build the networks of a scene, with the blocks around them that the scene asks for.

    These are a frame window, a front end, a readout and an AXI4-Stream. If ``lean`` is set,
    hardware that the weights make useless is left out; see ``constants_of``.
    """
    scene = scene.chosen
    design, trained, settings = DESIGNS[scene.design], scene.networks(), scene.settings(lean)
    try:
        network = arrange(scene.arrangement, trained, design, settings)
        if scene.learning:
            assert isinstance(network, Engine), "no other design is let through"
            taught = Corrected.of(scene.mlps(), *expected_drift(scene))
            vectors = scene.vectors()
            rates = constants(taught, vectors.codes, SIGNAL.quantise(vectors.targets)[0])
            network = LearningEngine.of(network, taught, rates.tolist())
    except InputError:
        # If the fault is in one network alone, the message names that network's file.
        for member, held in zip(scene.members, trained, strict=True):
            if not held.plain:
                continue
            with naming(member.weights_path):
                constants_of(held, settings)
        with naming(scene.path):
            raise
    framed = network if scene.window.plain else Windowed(network, scene.window)
    with naming(scene.path):
        # Behind the memory of past samples the interval may be longer; the clocks are without it.
        scene.demand.refuse(network, f"design {scene.design}")
        replace(scene.demand, clocks=0).refuse(framed, f"design {scene.design}")
    network = framed
    if scene.interface == "axi_stream":
        return AxisNetwork(network, scene.argmax)
    drawn = scene.visualisation
    # Outputs are held for whoever looks at an instrument or at a profile.
    holds = drawn is not None or scene.front_end is not None
    if scene.argmax and isinstance(network, AtOnce):
        return replace(network, decides=True)
    if not holds and not scene.argmax:
        return network
    readout = Readout(
        network,
        drawn.load_profile if drawn else None,
        drawn.results if drawn else (),
        decides=scene.argmax,
        holds=holds,
    )
    if scene.front_end is None:
        return readout
    with naming(f"{scene.path}: front_end"):
        if scene.front_end.converter:
            reader = scene.front_end.converter_reader(network)
            if scene.uart:
                return UartInstrument(
                    reader,
                    readout=readout,
                    divisor=scene.uart.divisor,
                    analogue=bool(drawn and drawn.analogue),
                )
            return ConverterInstrument(reader, readout=readout)
        return Instrument(scene.front_end.scan_sequencer(network), readout=readout)


def task_of(scene: Scene) -> SizingTask:
    around = [f"a section [{n}]" for n in ("front_end", "visualisation") if getattr(scene, n)]
    around += ["hardware.interface 'axi_stream'"] * (scene.interface == "axi_stream")
    around += ["data.window with past samples"] * (not scene.window.plain)
    codes = scene.vectors().codes
    inputs = scene.members[0].inputs
    with naming(scene.path):
        return SizingTask(
            scene.arrangement,
            scene.networks(),
            scene.settings(),
            scene.design,
            tuple(around),
            scene.argmax,
            np.asarray(codes)[:, :inputs],
        )


def compared(scene: Scene) -> tuple[list[Sized], list[Refused]]:
    """Every design of a scene with its costs, and those that cannot be built."""
    task = task_of(scene)
    found = all_sized(task)
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
        return choose(task, wanted, scene.device)


def chosen(scene: Scene, choice: Choice) -> Scene:
    settings = settings_for(task_of(scene), choice.row.candidate)
    return replace(
        scene,
        design=choice.row.candidate.design,
        design_options=dict(settings.options),
        activation=settings.activation,
        activation_options=dict(settings.activation_options),
    )
