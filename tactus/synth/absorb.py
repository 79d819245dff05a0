"""Moves registers into the multipliers and the memories of an ECP5.

A MULT18X18D has registers on its operands and on its product, and a DP16KD has one behind each of
its two ports. The vendors' tools move the registers around such a cell into it. Yosys leaves them
outside: then the wires to them take longer than the multiplication, and a word leaves its memory
5.7 ns after the clock instead of 0.6 ns.
"""

from collections import defaultdict
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

MULTIPLIER, MEMORY, REGISTER = "MULT18X18D", "DP16KD", "TRELLIS_FF"
WIDTHS = {"A": 18, "B": 18, "P": 36}
MEMORY_WIDTH = 18

Cell = dict[str, Any]


def plain(cell: Cell) -> bool:
    """Whether a register has no enable and no reset, which all bits of a word would share."""
    enable, reset = cell["connections"].get("CE", ["1"]), cell["connections"].get("LSR", ["0"])
    always = cell["parameters"].get("CEMUX", "1").strip() == "1" or enable == ["1"]
    clocked: bool = cell["parameters"].get("CLKMUX", "CLK") == "CLK"
    return always and reset == ["0"] and clocked


def absorb(cells: dict[str, Cell], outputs: set[Any]) -> int:
    """Move registers into the multipliers and memories of a flat netlist, and count the moves.

    ``outputs`` are the bits of the output ports.

    The registers of operands are moved when each bit of both operands is a constant or a plain
    register of one clock. Either both operands move or none does, because nextpnr knows no delays
    of a multiplier with a register on one operand alone. The registers of a product, or of the word
    at a memory's port, are moved when every bit that is used enters one plain register of one clock
    and nothing else. An operand's register that something else reads, too, stays where it is,
    beside the one in the multiplier. The register of a memory's word stays outside if it has an
    enable or a reset.
    """
    registers = {c["connections"]["Q"][0]: c for c in cells.values() if c["type"] == REGISTER}
    moved = 0
    for cell in [c for c in cells.values() if c["type"] == MULTIPLIER]:
        moved += _operands(cell, registers)
        moved += _behind(
            cell, [f"P{i}" for i in range(WIDTHS["P"])], cells, outputs, _product_clock
        )
    read = _readers(cells)
    for name, cell in list(cells.items()):
        if cell["type"] == REGISTER and cell["connections"]["Q"][0] not in outputs | read.keys():
            del cells[name]
    for cell in [c for c in cells.values() if c["type"] == MEMORY]:
        for side in "AB":
            ports = [f"DO{side}{i}" for i in range(MEMORY_WIDTH)]
            moved += _behind(cell, ports, cells, outputs, partial(_word_clock, side=side))
    return moved


def _readers(cells: dict[str, Cell]) -> dict[Any, list[tuple[str, str]]]:
    """For each bit, the cells and ports that read it."""
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


def _behind(
    cell: Cell,
    ports: Sequence[str],
    cells: dict[str, Cell],
    outputs: set[Any],
    take: Callable[[Cell, set[Any]], bool],
) -> bool:
    """Move the registers behind some ports into a cell, if the cell can ``take`` their clock."""
    wires, readers = cell["connections"], _readers(cells)
    bits = {port: wires[port][0] for port in ports if wires.get(port)}
    used = {port: readers[bit] for port, bit in bits.items() if bit in readers}
    ends = [end for found in used.values() for end in found]
    if not ends or len(ends) > len(used) or outputs & set(bits.values()):
        return False
    if not all(
        cells[name]["type"] == REGISTER and port == "DI" and plain(cells[name])
        for name, port in ends
    ):
        return False
    if not take(cell, {cells[name]["connections"]["CLK"][0] for name, _ in ends}):
        return False
    for port, ((name, _),) in used.items():
        wires[port] = cells[name]["connections"]["Q"]
        del cells[name]
    return True


def _product_clock(cell: Cell, clocks: set[Any]) -> bool:
    return _clock(cell, clocks, "OUTPUT")


def _word_clock(cell: Cell, clocks: set[Any], side: str) -> bool:
    """Use the register behind a port of a memory, if its clock and enables allow it."""
    wires, parameters = cell["connections"], cell["parameters"]
    alike = wires[f"CLK{side}"] == [*clocks] and parameters[f"CLK{side}MUX"] == f"CLK{side}"
    always = wires[f"OCE{side}"] == ["1"] and wires[f"RST{side}"] == ["0"]
    if not alike or not always or parameters[f"REGMODE_{side}"] != "NOREG":
        return False
    parameters[f"REGMODE_{side}"] = "OUTREG"
    return True


def _clock(cell: Cell, clocks: set[Any], *names: str) -> bool:
    """Give a multiplier's registers the clock, unless they have another one."""
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
