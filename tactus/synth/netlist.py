"""Counts cells and levels of logic in a netlist that Yosys has written as JSON."""

from collections import Counter
from collections.abc import Iterator
from graphlib import TopologicalSorter
from typing import Any

# The kinds that are counted, by the beginnings of Yosys' names of cells. A shift register sits in a
# LUT. An inverter is a kind of its own, because the logic behind it usually absorbs it.
KINDS = {
    "LUT": ("LUT", "SRL"),
    "inverter": ("INV",),
    "carry": ("MUXCY", "XORCY", "CARRY"),
    "flip-flop": ("FD",),
    "multiplier": ("MULT", "DSP"),
    "block RAM": ("RAMB",),
}
LATCHES = ("LD", "$_DLATCH", "$dlatch")
# Each of these is one level on a path. Carries and wide multiplexers have wires of their own and
# count as none.
LEVELS = ("LUT", "MULT", "DSP")
# Cells with a clock, at which a path ends.
CLOCKED = ("FD", "SRL", "RAMB", "LD")


def total(modules: dict[str, Any], name: str) -> Counter[str]:
    """The cells of a module and of its parts, by type."""
    found: Counter[str] = Counter()
    for kind, count in modules[name].items():
        if kind in modules:
            for inner, many in total(modules, kind).items():
                found[inner] += count * many
        else:
            found[kind] += count
    return found


def count(cells: Counter[str]) -> dict[str, int]:
    """The number of cells of each kind of ``KINDS``, from the number of each type."""
    return {
        kind: sum(n for cell, n in cells.items() if cell.startswith(names))
        for kind, names in KINDS.items()
    }


def clocked(cell: dict[str, Any]) -> bool:
    """Whether a path ends at a cell; a multiplier of Series 7 may have registers inside."""
    if cell["type"].startswith(CLOCKED):
        return True
    return any(
        int(value, 2) > 0
        for name, value in cell.get("parameters", {}).items()
        if cell["type"].startswith("DSP") and name in ("AREG", "BREG", "MREG", "PREG")
    )


def depth(module: dict[str, Any]) -> int:
    """How many LUTs and multipliers are on the longest path of a flat module.

    Paths run between registers or ports.
    """
    cells: dict[str, dict[str, Any]] = {}
    for name, cell in module["cells"].items():
        if cell["type"] == "LUT6_2":
            cells |= {f"{name} {port}": half for port, half in _halves(cell).items()}
        elif not clocked(cell):
            cells[name] = cell
    driver = {bit: name for name, cell in cells.items() for bit in _bits(cell, "output")}
    before = {
        name: {driver[bit] for bit in _bits(cell, "input") if bit in driver}
        for name, cell in cells.items()
    }
    level: dict[str, int] = {}
    for name in TopologicalSorter(before).static_order():
        own = int(cells[name]["type"].startswith(LEVELS))
        level[name] = own + max((level[other] for other in before[name]), default=0)
    return max(level.values(), default=0)


def _halves(cell: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """A LUT of two outputs as one of each output, with those inputs alone on which it depends."""
    init, pins = int(cell["parameters"]["INIT"], 2), {f"I{n}": 1 << n for n in range(6)}
    found = {}
    for port, entries in (("O6", range(64)), ("O5", range(32))):
        table = [init >> entry & 1 for entry in entries]
        used = {
            pin
            for pin, step in pins.items()
            if step < len(table) and any(table[n] != table[n ^ step] for n in entries)
        }
        connections = {
            pin: bits for pin, bits in cell["connections"].items() if pin in used or pin == port
        }
        found[port] = {**cell, "connections": connections}
    return found


def _bits(cell: dict[str, Any], direction: str) -> Iterator[Any]:
    for port, bits in cell["connections"].items():
        if cell["port_directions"][port] == direction:
            yield from bits
