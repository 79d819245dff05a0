"""Reads the netlist that GHDL's synthesis makes of VHDL, as ``--out=dump`` prints it.

GHDL 2.0 also prints Verilog, but with faults: a choice by ``case`` loses its ``when others``, and
an arithmetic shift becomes a logical one. Its netlist has neither fault. GHDL is told not to look
for memories (``-dm``, ``-de``): of a memory that is read in clocks without a write it would make
one that is read in clocks with a write.
"""

import re
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from golden.input_error import InputError

# The names of wires and tables that have no name in VHDL begin so; no name of MyHDL does.
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
    # The direction and the width of each port.
    ports: dict[str, tuple[str, int]] = field(default_factory=dict)
    gates: list[Gate] = field(default_factory=list)

    def children(self) -> set[str]:
        """The entities that it instantiates."""
        return {gate.kind for gate in self.gates[1:] if not gate.kind.startswith("$")}


def synthesise(files: Sequence[Path], top: str, folder: Path) -> dict[str, Module]:
    """GHDL's netlist of every entity that ``top`` needs.

    files: VHDL files in compile order.
    folder: The folder in which GHDL keeps its library.
    """
    return read_dump(dump(files, top, folder))


def dump(files: Sequence[Path], top: str, folder: Path) -> str:
    """What GHDL prints of the netlist; see ``synthesise``."""
    command = ["ghdl", "--synth", "--std=93", f"--workdir={folder}", "--out=dump", "-dm", "-de"]
    command += [*map(str, files), "-e", top]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode:
        raise InputError(f"{top}: ghdl --synth: {result.stderr.strip()}")
    return result.stdout


def read_dump(text: str) -> dict[str, Module]:
    """The netlists in what GHDL printed, by entity."""
    modules: dict[str, Module] = {}
    module: Module | None = None
    for line in text.splitlines():
        found = _MODULE.fullmatch(line)
        if found:
            module = modules.setdefault(found[1], Module(found[1]))
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
