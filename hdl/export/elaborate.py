"""Makes a MyHDL design with ports from the constants of a twin."""

from __future__ import annotations

import inspect
from typing import Any

from myhdl._block import _Block

from golden.block import Block
from golden.port import RESET, Port
from hdl.common.lookup import hardware
from hdl.common.signals import Group, Words, flag, reset, signed, unsigned
from hdl.export import literal_size, quick_inspect

quick_inspect.install()
literal_size.install()


def elaborate(spec: Block) -> _Block:
    """The hardware of ``spec`` by itself, with fresh signals on its ports."""
    return hardware(spec)(**port_signals(spec), spec=spec)


def port_signals(spec: Block) -> dict[str, Any]:
    """Fresh signals for every argument of the hardware, as the twin publishes its ports.

    An argument is one port, or ``Words`` of the ports ``name_0``, ``name_1``, ..., or a ``Group``
    of all ports whose names begin with the name of the argument.
    """
    ports = {port.name: port for port in spec.ports}
    found: dict[str, Any] = {}
    for name in inspect.signature(hardware(spec)).parameters:
        members = {
            other.removeprefix(f"{name}_"): port
            for other, port in ports.items()
            if other.startswith(f"{name}_") and port.number is not None
        }
        if name == "spec":
            continue
        if name in ports:
            found[name] = _signal(ports[name])
        elif members:
            found[name] = Words(len(members), lambda port=members["0"]: _signal(port))
        else:
            found[name] = Group(
                **{
                    other.removeprefix(f"{name}_"): _signal(port)
                    for other, port in ports.items()
                    if other.startswith(f"{name}_")
                }
            )
    return found


def _signal(port: Port) -> Any:
    if port.name == RESET.name:
        return reset()
    if not port.width:
        return flag()
    return signed(port.width) if port.signed else unsigned(port.width)
