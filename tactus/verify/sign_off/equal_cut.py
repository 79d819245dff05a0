"""Cuts two netlists of one entity at the registers and signals that have the same name in both.

A wire that is cut becomes an input of the gates that read it, and an output of the gate that drives
it. A register becomes an input, which is its value now, and an output, which is its next value. The
same is done with each instance of a part and with each memory; words that are read at equal
addresses count as equal, also beyond the end of a memory. What is left of each netlist has neither
registers nor parts, and both have the same ports. If all outputs of both are the same functions,
then both entities do the same for ever when they start with equal registers and memories. This is
because the wires of one solve the equations of the other, and these have a single solution, since
there is no loop without a register.
"""

from collections import Counter
from collections.abc import Iterator
from itertools import count, islice
from typing import Any

# A bit of a netlist that Yosys writes: the number of a wire, or a constant.
Bit = int | str
Netlist = dict[str, Any]
# One bit of a wire, by its name in the source.
Name = tuple[str, int]


class UncutError(ValueError):
    """Two netlists cannot be cut alike, for example because only one has a register."""


class Side:
    """One of both netlists: the names of its bits, and what drives them."""

    def __init__(self, netlist: Netlist) -> None:
        self.ports: dict[str, Any] = netlist["ports"]
        self.names: dict[Name, Bit] = {}
        for name, wire in sorted(netlist["netnames"].items()):
            if "init" in wire["attributes"]:
                raise UncutError(f"{name}: got an initial value, expected none")
            if not wire["hide_name"]:
                self.names |= {(name, place): bit for place, bit in enumerate(wire["bits"])}
        cells: dict[str, Any] = dict(netlist["cells"])
        self.fresh = count(1 + _highest(netlist))
        for name in [name for name, cell in cells.items() if cell["type"] == "$mem_v2"]:
            cells |= self._memory(name, cells[name])
        self.parts = {name: c for name, c in cells.items() if not c["type"].startswith("$")}
        registers = {name: c for name, c in cells.items() if c["type"] == "$dff"}
        apart = self.parts.keys() | registers.keys()
        self.gates = {name: cell for name, cell in cells.items() if name not in apart}
        # The next value of each bit of a register.
        self.next: dict[Bit, Bit] = {}
        for name, cell in registers.items():
            self._check_clock(name, cell)
            wires = cell["connections"]
            self.next |= dict(zip(wires["Q"], wires["D"], strict=True))
        for name, cell in self.gates.items():
            _check_gate(name, cell)
        self.driven = {bit for cell in self.gates.values() for bit in cell["connections"]["Y"]}
        self._check_drivers(registers)

    def _check_drivers(self, registers: dict[str, Any]) -> None:
        """Refuse a wire that has not exactly one driver."""
        drivers: Counter[Bit] = Counter()
        for port in self.ports.values():
            if port["direction"] == "input":
                drivers.update(port["bits"])
        for cell in (*self.gates.values(), *self.parts.values(), *registers.values()):
            for port, bits in cell["connections"].items():
                if cell["port_directions"][port] == "output":
                    drivers.update(bits)
        read = {bit for bit in (*self._bits(), *self.next.values()) if isinstance(bit, int)}
        for bit in sorted(read | drivers.keys()):
            if drivers[bit] != 1:
                names = ", ".join(name for (name, _), other in self.names.items() if other == bit)
                raise UncutError(f"{names or bit}: got {drivers[bit]} drivers, expected 1")

    def _check_clock(self, name: str, cell: dict[str, Any]) -> None:
        got = cell["connections"]["CLK"], int(cell["parameters"]["CLK_POLARITY"], 2)
        if got != (self.ports["clk"]["bits"], 1):
            raise UncutError(f"{name}: got clock and edge {got}, expected the rising edge of clk")

    def cut(self, places: dict[Name, Bit]) -> tuple[Netlist, list[Bit]]:
        """What is left, with ports in place of registers and parts; and its undefined bits.

        Each undefined bit becomes a wire without a driver.
        """
        wires = [bit for bit in places.values() if bit in self.driven]
        instead: dict[Bit, Bit] = dict(zip(wires, self.fresh, strict=False))
        unknown: list[Bit] = []

        def read(bits: list[Bit]) -> list[Bit]:
            return [_unknown() if bit == "x" else instead.get(bit, bit) for bit in bits]

        def _unknown() -> Bit:
            unknown.append(next(self.fresh))
            return unknown[-1]

        ports = {
            name: {"direction": port["direction"], "bits": read(port["bits"])}
            for name, port in self.ports.items()
        }
        for name, part in self.parts.items():
            for port, bits in part["connections"].items():
                inward = part["port_directions"][port] == "input"
                direction = "output" if inward else "input"
                ports[f"{name}.{port}"] = {"direction": direction, "bits": read(bits)}
        for (name, _), bit in places.items():
            held = ports.setdefault(f"{name}:held", {"direction": "input", "bits": []})
            held["bits"] += read([bit])
            made = ports.setdefault(f"{name}:made", {"direction": "output", "bits": []})
            made["bits"] += read([self.next[bit]]) if bit in self.next else [bit]
        cells = {
            name: cell
            | {
                "connections": {
                    port: bits if port == "Y" else read(bits)
                    for port, bits in cell["connections"].items()
                }
            }
            for name, cell in self.gates.items()
        }
        return {"ports": ports, "cells": cells, "netnames": {}}, unknown

    def _memory(self, name: str, cell: dict[str, Any]) -> dict[str, Any]:
        """A memory as a part whose ports are its reads and writes.

        Data and address do not count where nothing is written, so gates hide them then.
        """
        facts, wires = cell["parameters"], cell["connections"]
        reads, writes, width, depth, size = (
            int(facts[key], 2) for key in ("RD_PORTS", "WR_PORTS", "WIDTH", "ABITS", "SIZE")
        )
        clocks = [self.ports["clk"]["bits"][0]] * writes
        edges = int(facts["WR_CLK_ENABLE"], 2) & int(facts["WR_CLK_POLARITY"], 2)
        if int(facts["RD_CLK_ENABLE"], 2) or wires["WR_CLK"] != clocks or edges + 1 != 1 << writes:
            raise UncutError(
                f"{name}: got a memory with a clocked read or another write clock, expected reads "
                "without a clock and writes at the rising edge of clk"
            )
        if set(facts["INIT"]) != {"x"}:
            raise UncutError(f"{name}: got a memory with initial contents, expected none")
        ports: dict[str, list[Bit]] = {}
        gates: dict[str, Any] = {}

        def gate(kind: str, *operands: list[Bit]) -> list[Bit]:
            wide = 1 if kind == "$reduce_or" else len(operands[0])
            out: list[Bit] = list(islice(self.fresh, wide))
            gates[f"{name}$gate{out[0]}"] = _gate(kind, operands, out)
            return out

        for n in range(reads):
            ports[f"read{n}"] = wires["RD_ADDR"][n * depth : (n + 1) * depth]
            ports[f"got{n}"] = wires["RD_DATA"][n * width : (n + 1) * width]
        for n in range(writes):
            enable = wires["WR_EN"][n * width : (n + 1) * width]
            ports[f"enable{n}"] = enable
            data = wires["WR_DATA"][n * width : (n + 1) * width]
            ports[f"data{n}"] = gate("$and", data, enable)
            place = wires["WR_ADDR"][n * depth : (n + 1) * depth]
            ports[f"place{n}"] = gate("$and", place, gate("$reduce_or", enable) * depth)
        part = {
            "type": f"memory of {size} words of {width} bits",
            "connections": ports,
            "port_directions": {
                port: "output" if port.startswith("got") else "input" for port in ports
            },
        }
        return {name: part, **gates}

    def _bits(self) -> Iterator[Bit]:
        for port in self.ports.values():
            yield from port["bits"]
        for cell in (*self.gates.values(), *self.parts.values()):
            for bits in cell["connections"].values():
                yield from bits
        yield from self.next


def _highest(netlist: Netlist) -> int:
    """The highest number of a wire."""
    wires = [wire["bits"] for wire in netlist["netnames"].values()]
    return max((bit for bits in wires for bit in bits if isinstance(bit, int)), default=0)


def _gate(kind: str, operands: tuple[list[Bit], ...], out: list[Bit]) -> dict[str, Any]:
    """A gate of unsigned operands, as Yosys writes it."""
    parameters = {"Y_WIDTH": f"{len(out):032b}"}
    for port, bits in zip("AB", operands, strict=False):
        parameters |= {f"{port}_WIDTH": f"{len(bits):032b}", f"{port}_SIGNED": f"{0:032b}"}
    ports = "AB"[: len(operands)]
    return {
        "hide_name": 1,
        "type": kind,
        "parameters": parameters,
        "attributes": {},
        "port_directions": {**dict.fromkeys(ports, "input"), "Y": "output"},
        "connections": {**dict(zip(ports, operands, strict=True)), "Y": out},
    }


def _check_gate(name: str, cell: dict[str, Any]) -> None:
    outputs = [port for port, way in cell["port_directions"].items() if way == "output"]
    if outputs != ["Y"]:
        raise UncutError(f"{name}: got {cell['type']}, expected a gate without memory")


def cut_alike(gold: Netlist, gate: Netlist, signals: bool = True) -> tuple[Netlist, Netlist, int]:
    """What is left of both netlists, and how many bits of registers were cut.

    gold, gate: Netlists as Yosys writes them, with gates as wide as words and with plain registers.
    signals: Whether to cut also at the signals that both name, or only at registers and parts.
    """
    sides = Side(gold), Side(gate)
    parts = [{name: part["type"] for name, part in side.parts.items()} for side in sides]
    if parts[0] != parts[1]:
        raise UncutError(f"parts: got {parts[1]}, expected {parts[0]}")
    places: tuple[dict[Name, Bit], dict[Name, Bit]] = {}, {}
    taken: tuple[set[Bit], set[Bit]] = set(), set()
    for name in sorted(sides[0].names.keys() & sides[1].names.keys()):
        pair = [side.names[name] for side in sides]
        held = [bit in side.next for bit, side in zip(pair, sides, strict=True)]
        made = [signals and bit in side.driven for bit, side in zip(pair, sides, strict=True)]
        if not (all(held) or all(made)) or pair[0] in taken[0] or pair[1] in taken[1]:
            continue
        for n, bit in enumerate(pair):
            places[n][name] = bit
            taken[n].add(bit)
    for side, cut, whose in zip(sides, taken, ("Verilog", "VHDL"), strict=True):
        alone = side.next.keys() - cut
        if alone:
            names = sorted({name for (name, _), bit in side.names.items() if bit in alone})
            raise UncutError(
                f"got {len(alone)} register bits in the {whose} alone, expected them in both: "
                f"{', '.join(names)}"
            )
    left = [side.cut(cut) for side, cut in zip(sides, places, strict=True)]
    # Both must be the same whatever the undefined bits are, so these become inputs of both.
    extra = [len(unknown) for _, unknown in left]
    if any(extra):
        for (netlist, unknown), side, before in zip(left, sides, (0, extra[0]), strict=True):
            bits: list[Bit] = [*islice(side.fresh, before), *unknown]
            bits += islice(side.fresh, sum(extra) - len(bits))
            netlist["ports"]["undefined"] = {"direction": "input", "bits": bits}
    ports = [
        {name: (port["direction"], len(port["bits"])) for name, port in netlist["ports"].items()}
        for netlist, _ in left
    ]
    if ports[0] != ports[1]:
        odd = sorted({name for name, _ in ports[0].items() ^ ports[1].items()})
        raise UncutError(f"got ports that differ, expected the same in both: {', '.join(odd)}")
    return left[0][0], left[1][0], len(sides[0].next)
