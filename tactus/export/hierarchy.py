"""Elaborates a twin in MyHDL, and converts it: one VHDL entity or Verilog module per block.

MyHDL 0.11 flattens a design on conversion, and its own hooks for sub-modules call a function that
Python 3.11 no longer has. Here every block that takes a ``spec`` is converted by itself, leaves
first, and its parent gets a port map in its place. Everything else (the parts of ``hdl/common``
and the private parts of a block) is inlined. The version of MyHDL is pinned, because this sets
attributes that MyHDL does not document.
"""

import inspect
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.metadata import version
from inspect import cleandoc
from operator import attrgetter
from pathlib import Path
from typing import Any

from myhdl import _block as myhdl_block
from myhdl._block import _Block
from myhdl._extractHierarchy import _UserVerilogCode, _UserVhdlCode

from golden.common.block import Block
from golden.common.port import RESET, Port
from hdl.common import ops
from hdl.common.lookup import hardware
from hdl.common.rom import Constants
from hdl.common.signals import Group, Stream, Words, flag, reset, signed, unsigned
from tactus.export.myhdl_changes import install, members
from tactus.export.tidy import SUFFIX, check_ports, comment_ports, tidy

install()

LANGUAGES = {"vhdl": "VHDL", "verilog": "Verilog"}
_ATTRIBUTE = re.compile(r"``spec\.([\w.]+)``")


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


class _Instance:
    """An instance of an entity, whose signals have their names only when it is written."""

    def __init__(self, label, entity, ports):
        self.label, self.entity, self.ports = label, entity, ports


class _VhdlInstance(_Instance, _UserVhdlCode):
    def __str__(self):
        ports = ",\n".join(f"        {formal} => {s._name}" for formal, s in self.ports.items())
        return f"\n{self.label}: entity work.{self.entity}\n    port map (\n{ports}\n    );\n\n"


class _VerilogInstance(_Instance, _UserVerilogCode):
    def __str__(self):
        ports = ",\n".join(f"    .{formal}({s._name})" for formal, s in self.ports.items())
        return f"\n{self.entity} {self.label} (\n{ports}\n);\n\n"


_INSTANCE = {"vhdl": _VhdlInstance, "verilog": _VerilogInstance}


def convert_hierarchy(
    top: _Block, folder: Path, language: str, origin: str | None = None
) -> list[Block]:
    """Convert ``top`` and every block under it into ``folder``, one file per entity.

    folder: An existing folder; each file is named after its entity.
    language: "vhdl" or "verilog".
    origin: What the design was made from, for the heading of every file.

    Returns: The specs in compile order.
    """
    done: dict[str, Block] = {}
    _convert(top, folder, language, origin, done)
    return list(done.values())


def _convert(instance: _Block, folder: Path, language: str, origin: str | None, done: dict) -> None:
    spec = instance.kwargs["spec"]
    if spec.entity in done:
        if done[spec.entity] != spec:
            raise ValueError(
                f"{spec.entity}: got two different blocks with this entity name, expected one"
            )
        return
    children = list(_entities(instance))
    for child in children:
        _convert(child, folder, language, origin, done)
    with _replaced(instance, children, language):
        instance.convert(
            hdl=LANGUAGES[language],
            path=str(folder),
            name=spec.entity,
            no_myhdl_header=True,
            initial_values=False,
            **({"testbench": False} if language == "verilog" else {}),
        )
    file = folder / f"{spec.entity}{SUFFIX[language]}"
    text = file.read_text(encoding="utf-8")
    text = tidy(text, language, heading(instance, origin), _meanings(instance))
    check_ports(spec, text, language)
    file.write_text(comment_ports(spec, text, language), encoding="utf-8")
    done[spec.entity] = spec


def _entities(instance: _Block) -> Iterator[_Block]:
    """The blocks below ``instance`` that become entities, without those inside them.

    On the way the inlined parts get names that do not depend on what was elaborated before.
    """
    count: Counter[str] = Counter()

    def visit(parent: _Block) -> Iterator[_Block]:
        for sub in parent.subs:
            if not isinstance(sub, _Block):
                continue
            if "spec" in sub.kwargs:
                yield sub
                continue
            # Operations are counted by themselves: they give no name where a variable does.
            prefix = "op_" if sub.func.__module__ == ops.__name__ else ""
            name = sub.kwargs.get("label", f"{prefix}{sub.func.__name__}")
            sub.name = sub.__name__ = f"{name}{count[name]}"
            count[name] += 1
            yield from visit(sub)

    yield from visit(instance)


@contextmanager
def _replaced(instance: _Block, children: list[_Block], language: str):
    """Let ``children`` convert as instances of their entities."""
    attribute = f"{language}_code"
    count: Counter[str] = Counter()
    hidden = []
    _name_grouped_signals(instance)
    for child in children:
        spec = child.kwargs["spec"]
        child._inferInterface()
        ports = {name: child.argdict[name] for name in child.argnames}
        if len({id(signal) for signal in ports.values()}) < len(ports):
            raise ValueError(
                f"{spec.entity}: got two ports on one signal, expected a signal for each: the "
                "exported file would read only one of them"
            )
        label = f"u_{spec.block}_{count[spec.block]}"
        count[spec.block] += 1
        setattr(child, attribute, _INSTANCE[language](label, spec.entity, ports))
        outputs = {port.name for port in spec.ports if port.direction == "out"}
        for name, signal in ports.items():
            # _inferInterface names a signal after the child's port, and MyHDL only declares what
            # has no name yet.
            signal._name = None
            signal._markUsed()
            # Outputs are marked, too, because a parent may leave an output of a child open.
            signal.read = True
            if name in outputs:
                signal.driven = "wire"
        hidden.append((child, child.subs, child.sigdict, child.memdict))
        child.subs, child.sigdict, child.memdict = [], {}, {}
    myhdl_block._name_set.clear()
    try:
        yield
    finally:
        for child, subs, sigdict, memdict in hidden:
            setattr(child, attribute, None)
            child.subs, child.sigdict, child.memdict = subs, sigdict, memdict


def _name_grouped_signals(instance: _Block) -> None:
    """Declare the members of groups, since MyHDL declares only signals that are local variables."""
    for name, value in instance.symdict.items():
        if not isinstance(value, Stream):
            _name_members(instance, name, value)
    _name_streams(instance)


def _name_streams(instance: _Block) -> None:
    """Declare members of streams that have no other variable, in inlined parts as well."""
    for name, value in instance.symdict.items():
        if isinstance(value, Stream):
            _name_members(instance, name, value)
    for sub in instance.subs:
        if isinstance(sub, _Block) and "spec" not in sub.kwargs:
            _name_streams(sub)


def _name_members(instance: _Block, name: str, value: object) -> None:
    for member, signal in members(name, value):
        instance.sigdict.setdefault(member, signal)


def _meanings(instance: _Block) -> dict[str, tuple[str, ...]]:
    """What the words of tables stand for, by the label of the reading process or by the memory."""
    found: dict[str, tuple[str, ...]] = {}
    # MyHDL calls a table by its name in the outermost block that has it.
    named: set[int] = set()

    def visit(parent: _Block, prefix: str) -> None:
        for name, value in parent.symdict.items():
            if isinstance(value, Constants) and id(value) not in named:
                named.add(id(value))
                found[f"{prefix}{name}"] = tuple(value.meanings)
        for sub in parent.subs:
            if isinstance(sub, _Block) and "spec" not in sub.kwargs:
                if "meanings" in sub.kwargs:
                    found[f"{prefix}{sub.name}_read"] = tuple(sub.kwargs["meanings"])
                visit(sub, f"{prefix}{sub.name}_")

    visit(instance, "")
    return found


def heading(instance: _Block, origin: str | None) -> list[str]:
    """Lines for the top of the file of ``instance``, without comment signs.

    origin: What the design was made from, such as "scene digit".
    """
    spec = instance.kwargs["spec"]
    of = f" of {origin}" if origin else ""
    return [
        f"{spec.entity}{of}. Generated by tactus {version('tactus')}, do not edit.",
        "",
        *describe(instance.func.__doc__, spec).splitlines(),
    ]


def describe(docstring: str, spec: Block) -> str:
    """A block's docstring, written for readers of the export, who see one instance and no Python.

    docstring: What stands between double backticks as ``spec.name`` is an attribute of the twin,
        and its value takes its place.
    """
    text = _ATTRIBUTE.sub(lambda found: str(attrgetter(found[1])(spec)), cleandoc(docstring))
    text = re.sub(r"``([^`]+)``", r"\1", text)
    text = re.sub(r"\b1 (bit|clock)s\b", r"1 \1", text)
    return text.strip()
