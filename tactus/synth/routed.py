"""Turns the netlist that nextpnr has placed and routed on an ECP5 into cells that can be simulated.

nextpnr changes the netlist: it puts pads around it, pairs the cells of carry chains, connects some
operands directly to a wire, writes constants as the state of a pin that nothing drives, and makes
a memory of four LUTs and one cell that passes on what is written.
"""

from typing import Any

from golden.input_error import InputError

Cell = dict[str, Any]
# A block's pin that nothing drives is high, or low where it is inverted.
IDLE = {None: "1", "INV": "0", "0": "0", "1": "1"}
BLOCKS = ("DP16KD", "MULT18X18D")
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
    """The bit at a port, if there is one."""
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
    if kind == "TRELLIS_FF":
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
