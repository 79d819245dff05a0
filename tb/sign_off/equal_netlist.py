"""The netlist that GHDL's synthesis makes of VHDL, as Verilog that Yosys and Icarus read.

GHDL 2.0 also prints Verilog itself, with faults: a choice by ``case`` loses its ``when others``, an
arithmetic shift becomes a logical one. Its netlist has neither. So the netlist is read here, as
``--out=dump`` prints it, and each gate becomes one line; a gate, a wire or a line that is not known
is an error. No gate is left out, merged or guessed.
"""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from golden.cli import CommandError

# Wires that VHDL does not name; no name in MyHDL's text begins so.
UNNAMED = "ghdl_"
_MODULE = re.compile(r"  module \{m\d+\} \\(\w+)")
_INSTANCE = re.compile(r"    instance ([\\%]\w+)\{i\d+\}: ([$\\]\w+)")
_PORT = re.compile(r"    (input|output) \\(\w+)(?:\[(\d+):0\])?;")
_INPUT = re.compile(r"      input (\S+)\{p\d+\} <- \S+\{n(\d+)w(\d+)\}")
_OUTPUT = re.compile(r" (\S+)\{n(\d+)w(\d+)\}")


@dataclass(frozen=True)
class Net:
    """A wire by its number, and how many bits it has."""

    number: int
    width: int

    def __str__(self) -> str:
        return f"{UNNAMED}{self.number}"


@dataclass
class Gate:
    """One instance of a netlist; ``kind`` is ``$add`` and such, or the name of an entity."""

    name: str
    kind: str
    parameters: list[int] = field(default_factory=list)
    inputs: dict[str, Net] = field(default_factory=dict)
    outputs: dict[str, Net] = field(default_factory=dict)


@dataclass
class Module:
    """The netlist of one entity."""

    name: str
    # Direction and width by name.
    ports: dict[str, tuple[str, int]] = field(default_factory=dict)
    gates: list[Gate] = field(default_factory=list)

    def children(self) -> set[str]:
        """The entities that it instantiates."""
        return {gate.kind for gate in self.gates[1:] if not gate.kind.startswith("$")}


def synthesise(files: Sequence[Path], top: str, folder: Path) -> dict[str, Module]:
    """GHDL's netlist of every entity that ``top`` needs.

    Parameters
    ----------
    files : sequence of Path
        VHDL in compile order.
    top : str
    folder : Path
        Where GHDL keeps its library.

    Raises
    ------
    CommandError
        With GHDL's message, when it refuses the files.
    """
    command = ["ghdl", "--synth", "--std=93", f"--workdir={folder}", "--out=dump", "-dm"]
    command += [*map(str, files), "-e", top]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode:
        raise CommandError(f"{top}: ghdl --synth: {result.stderr.strip()}")
    return read_dump(result.stdout)


def read_dump(text: str) -> dict[str, Module]:
    """The netlists in what GHDL printed, by entity.

    Raises
    ------
    ValueError
        For a line that is not known.
    """
    modules: dict[str, Module] = {}
    module: Module | None = None
    for line in text.splitlines():
        found = _MODULE.fullmatch(line)
        if found:
            module = modules.setdefault(found[1], Module(found[1]))
        elif line.startswith("  module ") or line.startswith("  instance "):
            module = None
        elif module is not None:
            _read_line(module, line)
    return modules


def _read_line(module: Module, line: str) -> None:
    words = line.split()
    if words[0] in ("#", "connect"):
        return
    port, instance, source = (form.fullmatch(line) for form in (_PORT, _INSTANCE, _INPUT))
    if port:
        module.ports[port[2]] = (port[1], int(port[3] or 0) + 1)
    elif instance:
        kind = instance[2].removeprefix("\\")
        module.gates.append(Gate(instance[1].removeprefix("\\"), kind))
    elif source:
        name = _member(source[1])
        module.gates[-1].inputs[name] = Net(int(source[2]), int(source[3]))
    elif words[0] == "outputs":
        for found in _OUTPUT.finditer(line):
            module.gates[-1].outputs[_member(found[1])] = Net(int(found[2]), int(found[3]))
    elif words[0] == "parameters":
        module.gates[-1].parameters = [int(word.partition("=")[2] or word) for word in words[1:]]
    else:
        raise ValueError(f"{module.name}: GHDL's netlist: got {line.strip()!r}, expected a gate")


def _member(name: str) -> str:
    r"""``data`` of ``%467.$data`` or of ``\u_cascade_0.\data``."""
    return name.rpartition(".")[2].lstrip("$\\")


def list_lengths(text: str) -> dict[str, int]:
    """How many elements the signals have that are arrays, of an entity that MyHDL wrote."""
    ends = dict(re.findall(r"type (\w+) is array\(0 to (\d+)\)", text))
    signals = re.findall(r"signal (\w+): (t_array_\w+);", text)
    return {name: int(ends[kind]) + 1 for name, kind in signals}


def to_verilog(module: Module, lists: dict[str, int]) -> str:
    """The Verilog of a netlist.

    Parameters
    ----------
    module : Module
    lists : dict of str to int
        How many elements the signals have that are arrays; GHDL makes one wire of them, here each
        element gets its name, ``name[0]``, as in Yosys' netlist of the Verilog.

    Raises
    ------
    ValueError
        For a gate that is not known.
    """
    return _Writer(module, lists).text()


class _Writer:
    """Writes one module; wires that VHDL names keep their name."""

    def __init__(self, module: Module, lists: dict[str, int]) -> None:
        own, *self.gates = module.gates
        if own.kind != module.name:
            raise ValueError(f"{module.name}: GHDL's netlist: got {own.kind}, expected its ports")
        self.module, self.own, self.lists = module, own, lists
        self.maker = {net: gate for gate in self.gates for net in gate.outputs.values()}
        self.names = {net: port for port, net in own.outputs.items()}
        for gate in self.gates:
            if gate.name.startswith(UNNAMED):
                raise ValueError(f"{module.name}: {gate.name}: {UNNAMED} begins unnamed wires")
            if gate.kind == "$signal":
                self.names[gate.outputs["o"]] = gate.name
        # What drives a signal or a port, and has no name, is called after it: so registers keep
        # the names that they have in both languages.
        for gate in self.gates:
            if gate.kind == "$signal":
                self.names.setdefault(gate.inputs["i"], gate.name)
        for port, net in own.inputs.items():
            self.names.setdefault(net, port)

    def text(self) -> str:
        """The whole module."""
        lines = [f"module {self.module.name} ({', '.join(self.module.ports)});"]
        for name, (direction, width) in self.module.ports.items():
            lines.append(f"{direction} {_range(width) if width > 1 else ''}{name};")
        declared = set(self.own.outputs)
        for gate in self.gates:
            for net in gate.outputs.values():
                name = self.name(net)
                if gate.kind == "$posedge" or name in declared:
                    continue
                declared.add(name)
                scalar = net.width == 1 and name in self.module.ports
                word = "reg" if self.is_register(net) else "wire"
                lines.append(f"{word} {'' if scalar else _range(net.width)}{name};")
        for gate in self.gates:
            lines += self.statements(gate)
        for port, net in self.own.inputs.items():
            lines += self.alias(port, net)
        return "\n".join([*lines, "endmodule", ""])

    def is_register(self, net: Net) -> bool:
        """Whether a wire is assigned in a process."""
        gate = self.maker[net]
        if gate.kind == "$signal" and self.name(gate.inputs["i"]) == gate.name:
            return self.is_register(gate.inputs["i"])
        return gate.kind == "$dff" and self.name(net) not in self.lists

    def alias(self, name: str, net: Net) -> list[str]:
        """That ``name`` is the wire, where it is not called so anyway."""
        return [f"assign {name} = {self.name(net)};"] if self.name(net) != name else []

    def name(self, net: Net) -> str:
        """What a wire is called."""
        return self.names.get(net, f"{UNNAMED}{net.number}")

    def clock(self, net: Net) -> str:
        """The wire whose rising edge clocks a register."""
        edge = self.maker[net]
        if edge.kind != "$posedge":
            raise ValueError(f"{self.module.name}: a clock: got {edge.kind}, expected $posedge")
        return self.name(edge.inputs["i"])

    def statements(self, gate: Gate) -> list[str]:
        """The lines of a gate."""
        inputs = {port: self.name(net) for port, net in gate.inputs.items()}
        if not gate.kind.startswith("$"):
            outputs = {port: self.name(net) for port, net in gate.outputs.items()}
            ports = ", ".join(f".{port}({wire})" for port, wire in (inputs | outputs).items())
            return [f"{gate.kind} {gate.name} ({ports});"]
        if gate.kind == "$posedge":
            return []  # Stands in the registers.
        if gate.kind == "$dff":
            return self.register(gate)
        out = gate.outputs["o"]
        if gate.kind == "$signal":
            lines = self.alias(gate.name, gate.inputs["i"])
            if gate.name in self.lists and self.maker[gate.inputs["i"]].kind != "$dff":
                lines += [
                    f"wire {_range(1 + high - low)}{name} = {gate.name}[{high}:{low}];"
                    for name, high, low in self.elements(gate.name, out.width)
                ]
            return lines
        if gate.kind not in GATES:
            raise ValueError(f"{self.module.name}: {gate.name}: got gate {gate.kind}, not known")
        return [f"assign {self.name(out)} = {GATES[gate.kind](gate, inputs, out.width)};"]

    def register(self, gate: Gate) -> list[str]:
        """A register, or one for each element of a list of signals."""
        net = gate.outputs["q"]
        name, data = self.name(net), self.name(gate.inputs["d"])
        edge = f"always @(posedge {self.clock(gate.inputs['clk'])})"
        if name not in self.lists:
            return [f"{edge} {name} <= {data};"]
        lines = []
        elements = list(self.elements(name, net.width))
        for element, high, low in elements:
            lines.append(f"reg {_range(1 + high - low)}{element};")
            lines.append(f"{edge} {element} <= {data}[{high}:{low}];")
        return [*lines, f"assign {name} = {{{', '.join(element for element, *_ in elements)}}};"]

    def elements(self, name: str, width: int) -> Iterator[tuple[str, int, int]]:
        """The elements of a list by their names, and their place; the first stands at the left."""
        count = self.lists[name]
        each = width // count
        for n in range(count):
            low = (count - 1 - n) * each
            yield f"\\{name}[{n}] ", low + each - 1, low


def constant(gate: Gate) -> int:
    """The bits of a constant as a number.

    Raises
    ------
    ValueError
        For a gate that is none, or one with bits that are neither 0 nor 1.
    """
    width = next(iter(gate.outputs.values())).width
    if gate.kind == "$const_SB32":
        (value,) = gate.parameters
        return (value - ((value >> 31) << 32)) & ((1 << width) - 1)
    if gate.kind in ("$const_UB32", "$const_bit"):
        # The rightmost 32 bits come first.
        return sum(word << 32 * n for n, word in enumerate(gate.parameters))
    raise ValueError(f"{gate.name}: got gate {gate.kind}, expected a constant of 0 and 1")


def _range(width: int) -> str:
    return f"[{width - 1}:0] "


def _constant(gate: Gate, _: dict[str, str], width: int) -> str:
    return f"{width}'h{constant(gate):x}"


def _choose(gate: Gate, wires: dict[str, str], _: int) -> str:
    """The input of the first select bit, from the right, that is set; else the default."""
    select, default, *choices = wires.values()
    if gate.parameters != [len(wires)] or gate.inputs["s"].width != len(choices):
        raise ValueError(f"{gate.name}: got {gate.parameters}, expected {len(wires)} inputs")
    if len(choices) == 1:
        return f"{select} ? {choices[0]} : {default}"

    def among(first: int, last: int) -> str:
        if first == last:
            return choices[first]
        middle = (first + last) // 2
        low = f"|{select}[{middle}:{first}]"
        return f"({low} ? {among(first, middle)} : {among(middle + 1, last)})"

    return f"|{select} ? {among(0, len(choices) - 1)} : {default}"


def _two(operator: str, signed: bool = False) -> "Writing":
    """Of two operands of the result's width, or of each other's."""
    form = "$signed({0}) {2} $signed({1})" if signed else "{0} {2} {1}"
    return lambda gate, wires, _: form.format(wires["a"], wires["b"], operator)


def _extended(gate: Gate, wires: dict[str, str], width: int) -> str:
    more = width - gate.inputs["i"].width
    top = f"{wires['i']}[{gate.inputs['i'].width - 1}]" if gate.inputs["i"].width > 1 else wires["i"]
    bit = top if gate.kind == "$sextend" else "1'b0"
    return f"{{{{{more}{{{bit}}}}}, {wires['i']}}}" if more else wires["i"]


def _part(gate: Gate, wires: dict[str, str], width: int) -> str:
    low = gate.parameters[0] if gate.parameters else 0
    if gate.inputs["i"].width == 1:
        return wires["i"]
    return f"{wires['i']}[{low + width - 1}:{low}]"


def _joined(_: Gate, wires: dict[str, str], __: int) -> str:
    """The first input stands at the left."""
    return f"{{{', '.join(wires.values())}}}"


Writing = Callable[[Gate, dict[str, str], int], str]
# What the output of a gate is.
GATES: dict[str, Writing] = {
    "$const_UB32": _constant,
    "$const_SB32": _constant,
    "$const_bit": _constant,
    "$not": lambda gate, wires, width: f"~{wires['i']}",
    "$neg": lambda gate, wires, width: f"-{wires['i']}",
    "$and": _two("&"),
    "$or": _two("|"),
    "$xor": _two("^"),
    "$add": _two("+"),
    "$sub": _two("-"),
    "$smul": _two("*", signed=True),
    "$umul": _two("*"),
    "$lsl": _two("<<"),
    "$lsr": _two(">>"),
    "$asr": lambda gate, wires, width: f"$signed({wires['a']}) >>> {wires['b']}",
    "$eq": _two("=="),
    "$ne": _two("!="),
    "$ult": _two("<"),
    "$ule": _two("<="),
    "$ugt": _two(">"),
    "$uge": _two(">="),
    "$slt": _two("<", signed=True),
    "$sle": _two("<=", signed=True),
    "$sgt": _two(">", signed=True),
    "$sge": _two(">=", signed=True),
    "$mux2": lambda gate, wires, width: f"{wires['s']} ? {wires['i1']} : {wires['i0']}",
    "$mux4": lambda gate, wires, width: (
        "{s}[1] ? {s}[0] ? {i3} : {i2} : {s}[0] ? {i1} : {i0}".format(**wires)
    ),
    "$pmux": _choose,
    "$extract": _part,
    "$utrunc": _part,
    "$strunc": _part,
    "$uextend": _extended,
    "$sextend": _extended,
    "$concat2": _joined,
    "$concat3": _joined,
    "$concat4": _joined,
    "$concatn": _joined,
}
