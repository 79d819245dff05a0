"""From a twin's constants to a MyHDL design with ports."""

from __future__ import annotations

from myhdl._block import _Block

from golden.activation.activation_block import ActivationBlock
from golden.networks.network import Network
from hdl.common.lookup import hardware
from hdl.common.signals import fixed, flag, reset
from hdl.export import literal_size, quick_inspect

quick_inspect.install()
literal_size.install()


def elaborate(spec: Network) -> _Block:
    """The network of ``spec`` with fresh signals on its ports, which its hardware publishes."""
    top = hardware(spec)
    return top(*top.ports(spec), spec=spec)


def elaborate_activation(spec: ActivationBlock) -> _Block:
    """The activation of ``spec`` by itself with fresh signals on its ports."""
    return hardware(spec)(
        flag(), reset(), flag(), fixed(spec.in_fmt), flag(), fixed(spec.out_fmt), spec=spec
    )
