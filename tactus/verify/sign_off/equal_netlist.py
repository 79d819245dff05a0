"""Reads the netlist that GHDL's synthesis makes of VHDL, and writes it as Verilog.

GHDL 2.0 also prints Verilog, but with faults: a choice by ``case`` loses its ``when others``, and
an arithmetic shift becomes a logical one. Its netlist, which ``--out=dump`` prints, has neither
fault. GHDL is told not to look for memories (``-dm``, ``-de``): of a memory that is read in clocks
without a write it would make one that is read in clocks with a write.

Each gate becomes one line, and an unknown gate is an error. One fault of GHDL 2.0 is corrected: it
cuts a number to the width of the signal with which it is compared, so that ``slot < 2`` with one
bit becomes ``slot < 0``, though GHDL prints the whole number. Here both are compared as numbers, as
numeric_std does.
"""

from __future__ import annotations

import re
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from golden.input_error import InputError

# The names of wires and tables that have no name in VHDL begin so; no name of MyHDL does.
UNNAMED = "ghdl_"
_MODULE = re.compile(r"  module \{m\d+\} \\(\w+)")
_INSTANCE = re.compile(r"    instance ([\\%]\w+)\{i\d+\}: ([$\\]\w+)")
_PORT = re.compile(r"    (input|output) \\(\w+)(?:\[(\d+):0\])?;")
_INPUT = re.compile(r"      input (\S+)\{p\d+\} <- \S+\{n(\d+)w(\d+)\}")
_OUTPUT = re.compile(r" (\S+)\{n(\d+)w(\d+)\}")


class Net(NamedTuple):
    """A wire by its number, and how many bits it has."""

    number: int
    width: int


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
    """An entity.

    ports: The direction and the width of each.
    lists: The number of elements of each array signal. GHDL makes one wire of an array.
    """

    name: str
    lists: dict[str, int]
    ports: dict[str, tuple[str, int]] = field(default_factory=dict)
    gates: list[Gate] = field(default_factory=list)

    def children(self) -> set[str]:
        return {gate.kind for gate in self.gates[1:] if not gate.kind.startswith("$")}


def netlists(files: Sequence[Path], top: str) -> dict[str, Module]:
    """GHDL's netlist of every entity that ``top`` needs, of VHDL files in compile order."""
    return read_dump(dump(files, top), files)


def dump(files: Sequence[Path], top: str) -> str:
    """What GHDL prints of the netlists; see ``netlists``."""
    with tempfile.TemporaryDirectory() as library:
        command = ["ghdl", "--synth", "--std=93", f"--workdir={library}", "--out=dump"]
        command += ["-dm", "-de", *(str(file.resolve()) for file in files), "-e", top]
        result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode:
        raise InputError(f"{top}: ghdl --synth: {result.stderr.strip()}")
    return result.stdout


def read_dump(text: str, files: Sequence[Path]) -> dict[str, Module]:
    """The netlists in what GHDL printed of VHDL files, by entity."""
    written = {file.stem: file for file in files}
    modules: dict[str, Module] = {}
    module: Module | None = None
    for line in text.splitlines():
        found = _MODULE.fullmatch(line)
        if found:
            source = written[found[1]].read_text(encoding="utf-8")
            module = modules.setdefault(found[1], Module(found[1], list_lengths(source)))
        elif line.startswith(("  module ", "  instance ")):
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
    r"""The last part of a name: ``data`` for ``%467.$data`` or ``\u_cascade_0.\data``."""
    return name.rpartition(".")[2].lstrip("$\\")


def constant(gate: Gate) -> int:
    """The value of a constant, even if it does not fit its wire."""
    if gate.kind == "$const_SB32":
        (value,) = gate.parameters
        return value - ((value >> 31) << 32)
    if gate.kind in ("$const_UB32", "$const_bit"):
        # The rightmost 32 bits come first.
        return sum(word << 32 * n for n, word in enumerate(gate.parameters))
    raise ValueError(f"{gate.name}: got gate {gate.kind}, expected a constant of 0 and 1")


def wire_range(width: int) -> str:
    """The Verilog range of a wire with so many bits."""
    return f"[{width - 1}:0] "


def list_lengths(text: str) -> dict[str, int]:
    """The number of elements of each array signal in an entity that MyHDL wrote."""
    ends = dict(re.findall(r"type (\w+) is array\(0 to (\d+)\)", text))
    signals = re.findall(r"signal (\w+): (t_array_\w+);", text)
    return {name: int(ends[kind]) + 1 for name, kind in signals}


@dataclass
class Memory:
    """A list of words that is read or written one at a time; a table has a ``content``, too.

    reads, writes: Index and data of each access, and clock and enable of a write. The index counts
        the words from the right.
    """

    name: str
    count: int
    width: int
    content: int | None = None
    reads: list[tuple[Net, Net]] = field(default_factory=list)
    writes: list[tuple[Net, Net, Net, Net]] = field(default_factory=list)


def split_memories(gates: list[Gate], lists: dict[str, int]) -> tuple[list[Memory], list[Gate]]:
    """The memories among gates, and the other gates."""
    maker = {net: gate for gate in gates for net in gate.outputs.values()}
    memories: dict[Net, Memory] = {}
    gone: list[Gate] = []
    for insert in (gate for gate in gates if gate.kind == "$dyn_insert"):
        held, place = insert.inputs["v"], maker[insert.inputs["i"]]
        signal = maker[held]
        register = maker[signal.inputs["i"]]
        choice = maker[register.inputs["d"]]
        chosen = [choice.inputs.get(port) for port in ("i0", "i1")]
        if choice.kind != "$mux2" or chosen != [held, insert.outputs["o"]]:
            raise ValueError(f"{signal.name}: a memory, expected one write under one condition")
        count = lists[signal.name]
        memory = memories[held] = Memory(signal.name, count, held.width // count)
        _check_index(place, insert, memory)
        clock, enable = register.inputs["clk"], choice.inputs["s"]
        memory.writes.append((place.inputs["i"], insert.inputs["d"], clock, enable))
        gone += [insert, signal, place, register, choice]
    for extract in (gate for gate in gates if gate.kind == "$dyn_extract"):
        held, place, data = extract.inputs["v"], maker[extract.inputs["i"]], extract.outputs["o"]
        if held not in memories:
            table = maker[held]
            name, count = f"{UNNAMED}table{table.name.strip('%')}", held.width // data.width
            memories[held] = Memory(name, count, data.width, constant(table))
            gone.append(table)
        _check_index(place, extract, memories[held])
        memories[held].reads.append((place.inputs["i"], data))
        gone += [extract, place]
    left = [gate for gate in gates if not any(gate is other for other in gone)]
    missing = {net for gate in gone for net in gate.outputs.values()}
    missing -= {data for memory in memories.values() for _, data in memory.reads}
    for gate in left:
        if missing & set(gate.inputs.values()):
            raise ValueError(f"{gate.name}: {gate.kind}: got all words of a memory, expected one")
    return list(memories.values()), left


def _check_index(place: Gate, access: Gate, memory: Memory) -> None:
    if place.kind != "$memidx" or place.parameters[0] != memory.width or access.parameters != [0]:
        raise ValueError(
            f"{memory.name}: got {place.kind} {place.parameters}, expected whole words"
        )


def to_verilog(module: Module) -> str:
    """The Verilog of a netlist.

    Each element of an array signal gets its own name, ``name[0]``, as in Yosys' netlist of the
    Verilog.
    """
    return _Writer(module).text()


class _Writer:
    """Writes one module, in which wires that have a name in VHDL keep it."""

    def __init__(self, module: Module) -> None:
        own, *self.gates = module.gates
        if own.kind != module.name:
            raise ValueError(f"{module.name}: GHDL's netlist: got {own.kind}, expected its ports")
        self.module, self.own, self.lists = module, own, module.lists
        self.maker = {net: gate for gate in self.gates for net in gate.outputs.values()}
        self.names = {net: port for port, net in own.outputs.items()}
        for gate in self.gates:
            if gate.name.startswith(UNNAMED):
                raise ValueError(
                    f"{module.name}: {gate.name}: got a name that begins with {UNNAMED}, expected "
                    "another one: only unnamed wires begin so"
                )
            if gate.kind == "$signal":
                self.names[gate.outputs["o"]] = gate.name
        self.memories, self.gates = split_memories(self.gates, self.lists)
        # A wire without a name that drives a signal or a port takes the name of that. So registers
        # have the same names in both languages.
        for gate in self.gates:
            if gate.kind == "$signal":
                self.names.setdefault(gate.inputs["i"], gate.name)
        for port, net in own.inputs.items():
            self.names.setdefault(net, port)

    def text(self) -> str:
        lines = [f"module {self.module.name} ({', '.join(self.module.ports)});"]
        for name, (direction, width) in self.module.ports.items():
            lines.append(f"{direction} {wire_range(width) if width > 1 else ''}{name};")
        made = [n for gate in self.gates if gate.kind != "$posedge" for n in gate.outputs.values()]
        read = [data for memory in self.memories for _, data in memory.reads]
        declared = set(self.own.outputs)
        for net in (*made, *read):
            name = self.name(net)
            if name not in declared:
                declared.add(name)
                scalar = net.width == 1 and name in self.module.ports
                word = "reg" if self.is_register(net) else "wire"
                lines.append(f"{word} {'' if scalar else wire_range(self.width(net))}{name};")
        for gate in self.gates:
            lines += self.statements(gate)
        for memory in self.memories:
            lines += self.memory(memory)
        for port, net in self.own.inputs.items():
            lines += self.alias(port, net)
        return "\n".join([*lines, "endmodule", ""])

    def width(self, net: Net) -> int:
        """The width of a wire; it is wider than in GHDL's netlist where its number needs that."""
        gate = self.maker.get(net)
        if gate is None or not gate.kind.startswith("$const_"):
            return net.width
        value = constant(gate)
        return max(net.width, value.bit_length() + (gate.kind == "$const_SB32" and value < 0))

    def is_register(self, net: Net) -> bool:
        """Whether a wire is assigned in a process."""
        gate = self.maker[net]
        if gate.kind == "$signal" and self.name(gate.inputs["i"]) == gate.name:
            return self.is_register(gate.inputs["i"])
        return gate.kind == "$dff" and self.name(net) not in self.lists

    def alias(self, name: str, net: Net) -> list[str]:
        """An assignment of the wire to ``name``, unless the wire has that name already."""
        return [f"assign {name} = {self.name(net)};"] if self.name(net) != name else []

    def name(self, net: Net) -> str:
        return self.names.get(net, f"{UNNAMED}{net.number}")

    def clock(self, net: Net) -> str:
        """The wire whose rising edge clocks a register."""
        edge = self.maker[net]
        if edge.kind != "$posedge":
            raise ValueError(f"{self.module.name}: a clock: got {edge.kind}, expected $posedge")
        return self.name(edge.inputs["i"])

    def memory(self, memory: Memory) -> Iterator[str]:
        """The Verilog of a memory, whose first word stands at the left."""
        name, last = memory.name, memory.count - 1
        yield f"reg {wire_range(memory.width)}{name} [0:{last}];"
        if memory.content is not None:
            yield "initial begin"
            for n in range(memory.count):
                word = (memory.content >> (last - n) * memory.width) & ((1 << memory.width) - 1)
                yield f"    {name}[{n}] = {memory.width}'h{word:x};"
            yield "end"
        for n, (index, data, *write) in enumerate((*memory.reads, *memory.writes)):
            place = f"{name}_place{n}"
            yield f"wire {wire_range(index.width)}{place} = {self.from_left(index, last)};"
            if write:
                clock, enable = self.clock(write[0]), self.name(write[1])
                edge = f"always @(posedge {clock}) if ({enable})"
                yield f"{edge} {name}[{place}] <= {self.name(data)};"
            else:
                yield f"assign {self.name(data)} = {name}[{place}];"

    def from_left(self, index: Net, last: int) -> str:
        """The address of the word with an index that counts from the right.

        GHDL makes such an index by a subtraction from ``last``. Where it does, that is undone, so
        that both languages have the same gates at an address, and no solver must find this out.
        """
        gate = self.maker.get(index)
        if gate is not None and gate.kind == "$sub":
            minuend = self.maker.get(gate.inputs["a"])
            known = minuend is not None and minuend.kind.startswith("$const_")
            if minuend is not None and known and constant(minuend) == last:
                return self.name(gate.inputs["b"])
        return f"{last} - {self.name(index)}"

    def statements(self, gate: Gate) -> list[str]:
        inputs = {port: self.name(net) for port, net in gate.inputs.items()}
        if not gate.kind.startswith("$"):
            outputs = {port: self.name(net) for port, net in gate.outputs.items()}
            ports = ", ".join(f".{port}({wire})" for port, wire in (inputs | outputs).items())
            return [f"{gate.kind} {gate.name} ({ports});"]
        if gate.kind == "$posedge":
            return []  # The registers state their clock edge themselves.
        if gate.kind == "$dff":
            return self.register(gate)
        out = gate.outputs["o"]
        if gate.kind == "$signal":
            lines = self.alias(gate.name, gate.inputs["i"])
            if gate.name in self.lists and self.maker[gate.inputs["i"]].kind != "$dff":
                lines += [
                    f"wire {wire_range(1 + high - low)}{name} = {gate.name}[{high}:{low}];"
                    for name, high, low in self.elements(gate.name, out.width)
                ]
            return lines
        if gate.kind.startswith("$const_"):
            width = self.width(out)
            value = constant(gate) & ((1 << width) - 1)
            return [f"assign {self.name(out)} = {width}'h{value:x};"]
        made = expression(gate, inputs, out.width)
        if made is None:
            raise ValueError(f"{self.module.name}: {gate.name}: got gate {gate.kind}, not known")
        if any(self.width(net) > net.width for net in gate.inputs.values()):
            # A number that does not fit its wire may only be compared, and as an unsigned one.
            signs = {self.maker[net].kind for net in gate.inputs.values() if net in self.maker}
            if gate.kind not in UNSIGNED or "$const_SB32" in signs:
                found = f"{gate.name}: {gate.kind}"
                raise ValueError(f"{self.module.name}: {found}: a number is too wide")
        return [f"assign {self.name(out)} = {made};"]

    def register(self, gate: Gate) -> list[str]:
        net = gate.outputs["q"]
        name, data = self.name(net), self.name(gate.inputs["d"])
        edge = f"always @(posedge {self.clock(gate.inputs['clk'])})"
        if name not in self.lists:
            return [f"{edge} {name} <= {data};"]
        lines = []
        elements = list(self.elements(name, net.width))
        for element, high, low in elements:
            lines.append(f"reg {wire_range(1 + high - low)}{element};")
            lines.append(f"{edge} {element} <= {data}[{high}:{low}];")
        return [*lines, f"assign {name} = {{{', '.join(element for element, *_ in elements)}}};"]

    def elements(self, name: str, width: int) -> Iterator[tuple[str, int, int]]:
        """For each element of a list its name and its range; the first one stands at the left."""
        count = self.lists[name]
        each = width // count
        for n in range(count):
            low = (count - 1 - n) * each
            yield f"\\{name}[{n}] ", low + each - 1, low


# Comparisons of numbers without a sign.
UNSIGNED = {"$eq": "==", "$ne": "!=", "$ult": "<", "$ule": "<=", "$ugt": ">", "$uge": ">="}
# The operators whose operands have the width of the result, or both the same width.
TWO = UNSIGNED | {"$and": "&", "$or": "|", "$xor": "^", "$add": "+", "$sub": "-", "$umul": "*"}
TWO |= {"$lsl": "<<", "$lsr": ">>"}
SIGNED = {"$smul": "*", "$slt": "<", "$sle": "<=", "$sgt": ">", "$sge": ">="}
FORMS = {
    **{kind: f"{{a}} {operator} {{b}}" for kind, operator in TWO.items()},
    **{kind: f"$signed({{a}}) {operator} $signed({{b}})" for kind, operator in SIGNED.items()},
    "$asr": "$signed({a}) >>> {b}",
    "$not": "~{i}",
    "$neg": "-{i}",
    "$mux2": "{s} ? {i1} : {i0}",
    "$mux4": "{s}[1] ? {s}[0] ? {i3} : {i2} : {s}[0] ? {i1} : {i0}",
}


def expression(gate: Gate, wires: dict[str, str], width: int) -> str | None:
    """The expression for the output of a gate of known kind, of so many bits."""
    if gate.kind in FORMS:
        return FORMS[gate.kind].format(**wires)
    if gate.kind == "$pmux":
        return _choose(gate, wires)
    if gate.kind in ("$concat2", "$concat3", "$concat4", "$concatn"):
        # The first input stands at the left.
        return f"{{{', '.join(wires.values())}}}"
    if gate.kind in ("$extract", "$utrunc", "$strunc"):
        low = gate.parameters[0] if gate.parameters else 0
        part = f"[{low + width - 1}:{low}]" if gate.inputs["i"].width > 1 else ""
        return f"{wires['i']}{part}"
    if gate.kind in ("$uextend", "$sextend"):
        wire, given = wires["i"], gate.inputs["i"].width
        sign = f"{wire}[{given - 1}]" if given > 1 else wire
        bit = sign if gate.kind == "$sextend" else "1'b0"
        return f"{{{{{width - given}{{{bit}}}}}, {wire}}}" if width > given else wire
    return None


def _choose(gate: Gate, wires: dict[str, str]) -> str:
    """The input of the rightmost select bit that is set, or the default if none is."""
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
