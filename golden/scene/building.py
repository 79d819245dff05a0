"""The bit-true twin of a scene's hardware: its networks, and what the scene puts around them."""

from __future__ import annotations

from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING

from golden.cli import naming
from golden.input_error import InputError
from golden.instruments.converter_instrument import ConverterInstrument
from golden.instruments.instrument import Instrument
from golden.instruments.readout import Readout
from golden.instruments.uart_instrument import UartInstrument
from golden.mlp import Mlp
from golden.networks.arrangement import arrange
from golden.networks.axis_network import AxisNetwork
from golden.networks.constants import constants_of
from golden.networks.design import Design
from golden.networks.designs import DESIGNS
from golden.networks.network import Network
from golden.networks.windowed import Windowed

if TYPE_CHECKING:
    from golden.scene.scene import Scene


def build_twin(scene: Scene, lean: bool) -> Network:
    """The networks of a scene, with past, front end, readout or AXI4-Stream where it names them.

    ``lean`` leaves out what the weights make useless; see ``constants_of``.

    Raises
    ------
    InputError
        See ``load_network`` and ``constants_of``; also for a front end that cannot make the
        network's frames.
    """
    design = DESIGNS[scene.design]
    networks, build = scene.networks(), partial(scene.build, lean=lean)
    try:
        network = _of_several(scene, design, lean) or arrange(scene.arrangement, networks, build)
    except InputError:
        # What is wrong with one network alone is told of its file.
        for member, held in zip(scene.members, networks, strict=True):
            if not isinstance(held, Mlp):
                continue
            with naming(member.weights_path):
                constants_of(
                    held, scene.precision, scene.activation, scene.activation_options, lean
                )
        with naming(scene.path):
            raise
    if not scene.window.plain:
        network = Windowed(network, scene.window)
    if scene.interface == "axi_stream":
        return AxisNetwork(network)
    drawn = scene.visualisation
    if drawn is None and scene.front_end is None:
        return network
    readout = Readout(network, drawn.load_profile, drawn.results) if drawn else Readout(network)
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


def _of_several(scene: Scene, design: type[Design], lean: bool) -> Network | None:
    """The networks as one, where the design arranges them by itself.

    With a front end it may take the clocks that a scan leaves. Where nothing does, the instrument
    says so.
    """
    options = scene.design_options
    build = partial(
        design.of_several,
        scene.arrangement,
        scene.networks(),
        lean,
        activation_options=scene.activation_options,
    )
    if scene.front_end and "clocks" in design.options and "clocks" not in options:
        with suppress(InputError):
            within = options | {"clocks": scene.front_end.clocks_left(scene.window)}
            return build(hardware=within)
    return build(hardware=options)
