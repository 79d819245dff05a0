"""Netlists of an ECP5: registers that move into its cells, and routed cells to be simulated.

A MULT18X18D has registers on its operands and on its product, and a DP16KD has one behind each of
its two ports. The vendors' tools move the registers around such a cell into it. Yosys leaves them
outside: then the wires to them take longer than the multiplication, and a word leaves its memory
5.7 ns after the clock instead of 0.6 ns.

nextpnr changes the netlist that it places and routes: it puts pads around it, pairs the cells of
carry chains, connects some operands directly to a wire, writes constants as the state of a pin that
nothing drives, and makes a memory of four LUTs and one cell that passes on what is written.
"""

from collections import defaultdict
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from golden.input_error import InputError

MULTIPLIER, MEMORY, REGISTER = "MULT18X18D", "DP16KD", "TRELLIS_FF"
WIDTHS = {"A": 18, "B": 18, "P": 36}
MEMORY_WIDTH = 18

Cell = dict[str, Any]
# A block's pin that nothing drives is high, or low where it is inverted.
IDLE = {None: "1", "INV": "0", "0": "0", "1": "1"}
BLOCKS = (MEMORY, MULTIPLIER)
# A memory of LUTs is written through a cell beside them. These are the inputs of that cell, by its
# outputs. It takes the place of two LUTs, which are cells without wires.
WRITE_PINS = {
    "WADO0": "D0",
    "WADO1": "B0",
    "WADO2": "C0",
    "WADO3": "A0",
    "WDO0": "C1",
    "WDO1": "A1",
    "WDO2": "D1",
    "WDO3": "B1",
}
WRITER, WRITER_PLACE = "TRELLIS_RAMW", "RAMW_BLOCK"
# The inputs of such a LUT in the order of its address, the least significant first. Its contents
# are ordered as in any LUT, where A comes first.
READ_PINS = "DBCA"


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
        product = [f"P{i}" for i in range(WIDTHS["P"])]
        moved += _behind(cell, product, cells, outputs, partial(_clock, names=("OUTPUT",)))
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
    if not all(map(plain, found.values())) or not _clock(cell, clocks, ("INPUTA", "INPUTB")):
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


def _word_clock(cell: Cell, clocks: set[Any], side: str) -> bool:
    """Use the register behind a port of a memory, if its clock and enables allow it."""
    wires, parameters = cell["connections"], cell["parameters"]
    alike = wires[f"CLK{side}"] == [*clocks] and parameters[f"CLK{side}MUX"] == f"CLK{side}"
    always = wires[f"OCE{side}"] == ["1"] and wires[f"RST{side}"] == ["0"]
    if not alike or not always or parameters[f"REGMODE_{side}"] != "NOREG":
        return False
    parameters[f"REGMODE_{side}"] = "OUTREG"
    return True


def _clock(cell: Cell, clocks: set[Any], names: Sequence[str]) -> bool:
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


def simulated(netlist: dict[str, Any], top: str) -> dict[str, Any]:
    """The module that nextpnr wrote, without pads and with every input of its cells driven."""
    (module,) = netlist["modules"].values()
    cells: dict[str, Cell] = module["cells"]
    renamed: dict[Any, Any] = {}
    for name, cell in list(cells.items()):
        if cell["type"] == "TRELLIS_IO":
            _pad(cell, renamed)
        elif cell["type"] == "DCCA":
            renamed[_pin(cell, "CLKO")] = _pin(cell, "CLKI")
        elif cell["type"] == WRITER:
            for to, of in WRITE_PINS.items():
                # A bit to which Yosys gives no value is stored as unknown.
                bit = _pin(cell, of)
                renamed[_pin(cell, to)] = "x" if bit is None else bit
        elif cell["parameters"].get("MODE") == WRITER_PLACE:
            pass
        else:
            _drive(name, cell)
            continue
        del cells[name]
    for wires in (cell["connections"] for cell in cells.values()):
        wires |= {port: [_final(bit, renamed) for bit in bits] for port, bits in wires.items()}
    for port in module["ports"].values():
        port["bits"] = [_final(bit, renamed) for bit in port["bits"]]
    module["netnames"] = {}
    return {**netlist, "modules": {top: module}}


def _final(bit: Any, renamed: dict[Any, Any]) -> Any:
    while bit in renamed:
        bit = renamed[bit]
    return bit


def _pin(cell: Cell, port: str) -> Any:
    return next(iter(cell["connections"].get(port, [])), None)


def _pad(cell: Cell, renamed: dict[Any, Any]) -> None:
    """An input pad drives its wire; an output's wire is the port."""
    if cell["parameters"]["DIR"] == "INPUT":
        renamed[_pin(cell, "O")] = _pin(cell, "B")
    else:
        renamed[_pin(cell, "B")] = _pin(cell, "I")


def _drive(name: str, cell: Cell) -> None:
    """Put constants on pins that nothing drives, and keep the parameters of the cell's model."""
    kind, wires, parameters = cell["type"], cell["connections"], cell["parameters"]
    if kind == REGISTER:
        if parameters.pop("SD").strip() == "0":
            wires["DI"] = wires.pop("M")
        _default(wires, {"LSR": "0", "CE": "1", "M": "0"})
    elif kind == "TRELLIS_COMB":
        parameters["IS_Z1"] = "1" if wires.get("FXA") else "0"
        _default(wires, dict.fromkeys(("A", "B", "C", "D", "FCI", "F1", "FXA", "FXB", "M"), "1"))
        _default(wires, dict.fromkeys(("WD", "WAD0", "WAD1", "WAD2", "WAD3", "WRE", "WCK"), "0"))
        for port in ("DI0", "DI1"):
            wires.pop(port, None)
        if parameters.get("MODE") == "DPRAM":
            _memory(name, parameters)
    elif kind in BLOCKS:
        for port in [port for port, way in cell["port_directions"].items() if way == "input"]:
            state = parameters.pop(f"{port}MUX", None)
            state = None if state in (None, port) else state.strip()
            if not wires.get(port):
                wires[port] = [IDLE[state]]
            elif state:
                raise InputError(f"{name}: {port}: got {state} of a wire, expected the wire")
    else:
        raise InputError(f"{name}: got a {kind}, expected a cell that is known here")
    cell["connections"] = {port: bits for port, bits in wires.items() if bits}
    cell["port_directions"] = {
        port: cell["port_directions"].get(port, "input") for port in cell["connections"]
    }


def _memory(name: str, parameters: dict[str, str]) -> None:
    """Order the contents of a memory of one LUT by its address, as in Yosys' model."""
    for key, plain in (("WREMUX", "WRE"), ("WCKMUX", "WCK")):
        if parameters.get(key, plain) != plain:
            raise InputError(f"{name}: {key}: got {parameters[key]}, expected {plain}")
    held = parameters["INITVAL"][::-1]
    weights = [1 << "ABCD".index(pin) for pin in READ_PINS]
    by_address = [
        held[sum(weight for n, weight in enumerate(weights) if addr >> n & 1)] for addr in range(16)
    ]
    parameters["INITVAL"] = "".join(reversed(by_address))


def _default(wires: dict[str, list[Any]], states: dict[str, str]) -> None:
    for port, state in states.items():
        if not wires.get(port):
            wires[port] = [state]
