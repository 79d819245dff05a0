"""From a twin's constants to a MyHDL design with ports."""

from __future__ import annotations

from inspect import Parameter, signature

from myhdl import ResetSignal
from myhdl._block import _Block

from golden.activation.activation_block import ActivationBlock
from golden.networks.network import Network
from golden.precision import SIGNAL
from hdl.common.lookup import hardware
from hdl.common.signals import fixed, flag


def elaborate(spec: Network) -> _Block:
    """The network of ``spec`` with fresh signals on the ports that its block has."""
    ports = signature(hardware(spec)).parameters.values()
    names = [port.name for port in ports if port.kind is Parameter.POSITIONAL_OR_KEYWORD]
    return hardware(spec)(*(_port(name) for name in names), spec=spec)


def _port(name: str):
    """A port of a network by its name: clock and flags are bits, data are signals."""
    if name == "rst":
        return ResetSignal(0, active=1, isasync=False)
    return fixed(SIGNAL) if name.endswith(("_data", "_x", "_y")) else flag()


def elaborate_activation(spec: ActivationBlock) -> _Block:
    """The activation of ``spec`` by itself with fresh signals on its ports."""
    return hardware(spec)(
        flag(),
        ResetSignal(0, active=1, isasync=False),
        flag(),
        fixed(spec.in_fmt),
        flag(),
        fixed(spec.out_fmt),
        spec=spec,
    )
