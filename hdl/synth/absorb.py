"""Registers into the multipliers of an ECP5.

A MULT18X18D has registers on its operands and on its product. Vendors' tools move the registers
around a multiplier into it; Yosys leaves them outside, where their wires take longer than the
multiplication.
"""

from __future__ import annotations

from collections import defaultdict
from typing import Any

MULTIPLIER, REGISTER = "MULT18X18D", "TRELLIS_FF"
WIDTHS = {"A": 18, "B": 18, "P": 36}

Cell = dict[str, Any]


def plain(cell: Cell) -> bool:
    """Whether a register has neither enable nor reset, which all bits of a multiplier share."""
    enable, reset = cell["connections"].get("CE", ["1"]), cell["connections"].get("LSR", ["0"])
    always = cell["parameters"].get("CEMUX", "1").strip() == "1" or enable == ["1"]
    clocked: bool = cell["parameters"].get("CLKMUX", "CLK") == "CLK"
    return always and reset == ["0"] and clocked


def absorb(cells: dict[str, Cell], outputs: set[Any]) -> int:
    """Move registers into the multipliers of a flat netlist; how often.

    ``outputs`` are the bits of the output ports.

    The operands are moved when each of their bits is a constant or a plain register of one clock,
    both or none, because nextpnr knows no delays of a multiplier with a register on one operand
    alone; a product when every bit that is used enters one plain register of one clock and nothing
    else. A register that something else reads stays where it is beside that in the multiplier.
    """
    registers = {c["connections"]["Q"][0]: c for c in cells.values() if c["type"] == REGISTER}
    moved = 0
    readers = _readers(cells)
    for cell in [c for c in cells.values() if c["type"] == MULTIPLIER]:
        moved += _operands(cell, registers)
        moved += _product(cell, cells, readers)
    read = _readers(cells)
    for name, cell in list(cells.items()):
        if cell["type"] == REGISTER and cell["connections"]["Q"][0] not in outputs | read.keys():
            del cells[name]
    return moved


def _readers(cells: dict[str, Cell]) -> dict[Any, list[tuple[str, str]]]:
    """By bit the cells and ports that read it."""
    found: dict[Any, list[tuple[str, str]]] = defaultdict(list)
    for name, cell in cells.items():
        for port, bits in cell["connections"].items():
            if cell["port_directions"][port] == "input":
                for bit in bits:
                    found[bit].append((name, port))
    return found


def _operands(cell: Cell, registers: dict[Any, Cell]) -> bool:
    wires = cell["connections"]
    ports = [f"{operand}{i}" for operand in "AB" for i in range(WIDTHS[operand])]
    ports = [port for port in ports if wires[port][0] not in ("0", "1")]
    if not ports or any(wires[port][0] not in registers for port in ports):
        return False
    found = {port: registers[wires[port][0]] for port in ports}
    clocks = {register["connections"]["CLK"][0] for register in found.values()}
    if not all(map(plain, found.values())) or not _clock(cell, clocks, "INPUTA", "INPUTB"):
        return False
    for port, register in found.items():
        wires[port] = register["connections"]["DI"]
    return True


def _product(cell: Cell, cells: dict[str, Cell], readers: dict[Any, list[tuple[str, str]]]) -> bool:
    wires = cell["connections"]
    used = {f"P{i}": readers.get(wires[f"P{i}"][0], []) for i in range(WIDTHS["P"])}
    ends = [end for found in used.values() for end in found]
    if not ends or any(len(found) > 1 for found in used.values()):
        return False
    if not all(
        cells[name]["type"] == REGISTER and port == "DI" and plain(cells[name])
        for name, port in ends
    ):
        return False
    clocks = {cells[name]["connections"]["CLK"][0] for name, _ in ends}
    if not _clock(cell, clocks, "OUTPUT"):
        return False
    for port, found in used.items():
        for name, _ in found:
            wires[port] = cells[name]["connections"]["Q"]
            del cells[name]
    return True


def _clock(cell: Cell, clocks: set[Any], *names: str) -> bool:
    """Give a multiplier's registers the clock, unless it has another."""
    wires, parameters = cell["connections"], cell["parameters"]
    if len(clocks | set(wires.get("CLK0", clocks))) != 1:
        return False
    constants = {"CLK0": [*clocks], "CE0": ["1"], "RST0": ["0"]}
    for port, bits in constants.items():
        wires[port] = bits
        cell["port_directions"][port] = "input"
    for name in names:
        parameters |= {f"REG_{name}_{kind}": f"{kind}0" for kind in ("CLK", "CE", "RST")}
    return True
