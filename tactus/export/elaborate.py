"""Makes a MyHDL design with ports from the constants of a twin."""

import inspect
from collections.abc import Sequence
from typing import Any

from myhdl._block import _Block

from golden.common.block import Block
from golden.common.port import RESET, Port
from hdl.common.lookup import hardware
from hdl.common.signals import Group, Stream, Words, flag, reset, signed, unsigned
from tactus.export import interfaces, literal_size, quick_inspect

interfaces.install()
quick_inspect.install()
literal_size.install()


def elaborate(spec: Block) -> _Block:
    """The hardware of ``spec`` by itself, with fresh signals on its ports."""
    return hardware(spec)(**port_signals(spec), spec=spec)


def port_signals(spec: Block) -> dict[str, Any]:
    """Fresh signals for every argument of the hardware, as the twin publishes its ports.

    An argument is one port, or ``Words`` of the ports ``name_0``, ``name_1``, ..., or a ``Group``
    or a ``Stream`` of all ports whose names begin with the name of the argument. It is a ``Stream``
    where the hardware's annotation says so.
    """
    ports = {port.name: port for port in spec.ports}
    parameters = dict(inspect.signature(hardware(spec), eval_str=True).parameters)
    del parameters["spec"]
    return {
        name: _signal(ports[name])
        if name in ports
        else _members(f"{name.rstrip('_')}_", spec.ports, parameter.annotation)
        for name, parameter in parameters.items()
    }


def _members(prefix: str, ports: Sequence[Port], kind: type) -> Any:
    """``Words`` where the ports behind ``prefix`` are numbers, else a group of signals by name."""
    members = {
        port.name.removeprefix(prefix): port for port in ports if port.name.startswith(prefix)
    }
    if "0" in members:
        return Words(len(members), lambda: _signal(members["0"]))
    fields = {}
    for name, port in members.items():
        if port.number is None:
            fields[name] = _signal(port)
        elif not port.number:
            field = name.removesuffix("_0")
            fields[field] = _members(f"{prefix}{field}_", ports, Words)
    return Stream(**fields) if kind is Stream else Group(**fields)


def _signal(port: Port) -> Any:
    if port.name == RESET.name:
        return reset()
    if not port.width:
        return flag()
    return signed(port.width) if port.signed else unsigned(port.width)
