"""The ports that MyHDL makes of a block's arguments, where these are groups of signals.

MyHDL makes ports only of positional parameters. It names a signal of a group after the parameter
and the attribute, even if the parameter ends in an underscore, and it puts the signals of all
groups behind the other ports. This module lets every parameter be a port, makes ``in_valid`` of
``in_`` and ``valid``, and puts the signals of a ``Stream`` in the place that the twin gives them.
"""

import inspect
from collections.abc import Iterator
from typing import Any

from myhdl import _block, _resolverefs
from myhdl._Signal import _Signal

from hdl.common.signals import Group, Stream, Words

_suffixer = _resolverefs._suffixer


def member_name(group: str, member: str) -> str:
    """The name of a signal in a group: ``in_valid`` for the member ``valid`` of ``in_``."""
    return f"{group.rstrip('_')}_{member}"


def members(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    """Every signal of an argument or a local variable, by the name that it has as a port."""
    if isinstance(value, _Signal):
        yield name, value
    elif isinstance(value, Words | Group):
        for member, inner in vars(value).items():
            yield from members(member_name(name, member), inner)


def install() -> None:
    """Replace what MyHDL asks for the ports of a block and for the name of an attribute."""
    _block._Block._inferInterface = _infer_ports
    # The attribute of a parameter that ends in an underscore has two of them in a row.
    _resolverefs._suffixer = lambda name, used: _suffixer(name.replace("__", "_"), used)


def _infer_ports(instance: _block._Block) -> None:
    """Leave in a block instance the signals of its ports by name, in the order of its header.

    Ports stand in the twin's order, numbered ones and those of a ``Group`` behind the others. What
    else its streams hold is not the block's.
    """
    signature = inspect.signature(instance.func, eval_str=True)
    arguments = signature.bind(*instance.args, **instance.kwargs).arguments
    spec = arguments.pop("spec")
    published = {port.name: port for port in spec.ports}
    placed: dict[str, Any] = {}
    behind: dict[str, Any] = {}
    others = []
    for name, value in arguments.items():
        kind = signature.parameters[name].annotation
        apart = isinstance(value, Words | Group) and kind is not Stream
        for port, signal in members(name, value):
            if port not in published:
                others.append(port)
                continue
            numbered = published[port].number is not None
            (behind if apart or numbered else placed)[port] = signal
            # Whatever the local variable is called that holds it.
            signal._name = port
    instance.argdict = {port: placed[port] for port in published if port in placed} | behind
    instance.argnames = list(instance.argdict)
    missing = [port for port in published if port not in instance.argdict]
    if missing:
        raise ValueError(
            f"{spec.entity}: got signals {others}, expected {missing}, which the twin publishes"
        )
