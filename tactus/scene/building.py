"""Builds the bit-true twin of a scene's hardware: the networks, and what stands around them."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

from golden.input_error import InputError, naming
from golden.instruments.converter_instrument import ConverterInstrument
from golden.instruments.instrument import Instrument
from golden.instruments.readout import Readout
from golden.instruments.uart_instrument import UartInstrument
from golden.learning.corrected import Corrected
from golden.learning.gradient import constants
from golden.networks.arrangement import arrange
from golden.networks.at_once import AtOnce
from golden.networks.axis_network import AxisNetwork
from golden.networks.constants import constants_of
from golden.networks.design import Design
from golden.networks.designs import DESIGNS
from golden.networks.engine import Engine
from golden.networks.learning_engine import LearningEngine
from golden.networks.network import Network
from golden.networks.settings import Settings
from golden.networks.windowed import Windowed
from golden.numbers.precision import SIGNAL
from golden.trained.mlp import Mlp
from tactus.scene.choice import check_demand
from tactus.scene.disturbance import expected_drift

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
        network = _within_a_scan(scene, design, settings) or arrange(
            scene.arrangement, trained, design, settings
        )
        network = with_learning_engine(scene, network)
    except InputError:
        # If the fault is in one network alone, the message names that network's file.
        for member, held in zip(scene.members, trained, strict=True):
            if not isinstance(held, Mlp):
                continue
            with naming(member.weights_path):
                constants_of(held, settings)
        with naming(scene.path):
            raise
    framed = network if scene.window.plain else Windowed(network, scene.window)
    check_demand(scene, network, framed)
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


def _within_a_scan(scene: Scene, design: type[Design], settings: Settings) -> Network | None:
    """The networks built for the clocks that a scan leaves, if the design has an option for clocks.

    None if there is no such option, or if the design cannot be so fast; in that case the instrument
    reports the fault.
    """
    if scene.front_end and "clocks" in design.options and "clocks" not in settings.options:
        with suppress(InputError):
            clocks = {"clocks": scene.front_end.clocks_left(scene.window)}
            within = replace(settings, options={**settings.options, **clocks})
            return arrange(scene.arrangement, scene.networks(), design, within)
    return None


def taught_of(scene: Scene) -> tuple[Corrected, list[list[int]]]:
    """The networks of a scene behind corrected sensors, and the constants of each output."""
    taught = Corrected.of(scene.mlps(), *expected_drift(scene))
    vectors = scene.vectors()
    steps = constants(taught, vectors.codes, SIGNAL.quantise(vectors.targets)[0])
    return taught, steps.tolist()


def with_learning_engine(scene: Scene, network: Network) -> Network:
    """The engine of a scene, if the scene says so one that learns."""
    if not scene.learning:
        return network
    assert isinstance(network, Engine), "no other design is let through"
    return LearningEngine.of(network, *taught_of(scene))
