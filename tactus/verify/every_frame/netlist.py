"""The hardware as Yosys reads it: words and operators, before anything is optimised.

What is trusted here is Yosys' reading of the language. Every port of a cell is kept as pieces of
words, of known bits, and of X, so that the rest never meets a single bit.
"""

import json
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from tactus.verify.every_frame.bits import Piece, X, join, pieces

READ = "hierarchy -check -top {top}; proc; flatten; memory_collect; opt_clean"
# What these say concerns simulation and properties, not what the hardware does.
SILENT = "$scopeinfo", "$print", "$check", "$assert", "$assume", "$cover"


class NotReadableError(Exception):
    """Hardware that cannot be read, with the reason."""


class Net:
    """A word of the hardware. All words of a memory are one, with the width of each."""

    def __init__(self, name: str, width: int):
        self.name, self.width = name, width


Port = tuple[Piece, ...]


class Cell(NamedTuple):
    """An operator, a register ("$dff"), or a "read" at A of the memory M."""

    kind: str
    inputs: dict[str, Port]
    output: Net
    signed: dict[str, bool]


class Memory(NamedTuple):
    """At the `start` those words are X that are not known. A write has address, data, and an enable
    of each bit."""

    words: Net
    start: list[Any]
    write: tuple[Port, ...] | None


class Netlist(NamedTuple):
    inputs: dict[str, Net]
    outputs: dict[str, Port]
    cells: list[Cell]
    registers: list[Cell]
    memories: list[Memory]


def read_verilog(
    files: list[Path], top: str, yosys: Callable[[list[str], Path], object]
) -> Netlist:
    """The hardware of Verilog files; `yosys` runs Yosys with arguments in a folder."""
    with tempfile.TemporaryDirectory() as made:
        # Yosys as a package sees nothing but the folder that it runs in.
        folder, names = Path(made), [f"{k}.v" for k in range(len(files))]
        for name, file in zip(names, files, strict=True):
            shutil.copyfile(file, folder / name)
        read = f"read_verilog {' '.join(names)}; {READ.format(top=top)}; write_json netlist.json"
        yosys(["-q", "-p", read], folder)
        text = (folder / "netlist.json").read_text(encoding="utf-8")
        return netlist(json.loads(text)["modules"][top])


def netlist(module: dict[str, Any]) -> Netlist:
    """The module of that form of Yosys' JSON."""
    home: dict[Any, Piece] = {}

    def net(name: str, bits: list[Any]) -> Net:
        found = Net(name, len(bits))
        for k, bit in enumerate(bits):
            if bit in home:
                raise NotReadableError(f"{name}: a wire with two drivers")
            if isinstance(bit, int):
                home[bit] = found, k, 1
        return found

    def port(bits: list[Any]) -> Port:
        # A wire that nothing drives is unknown.
        known: dict[Any, Piece] = {"0": (0, 0, 1), "1": (1, 0, 1)}
        parts = [known.get(bit) or home.get(bit, (X, 0, 1)) for bit in bits]
        return pieces(join(parts), len(bits))

    ports: dict[str, dict[str, list[Any]]] = {"input": {}, "output": {}, "inout": {}}
    for name, one in module["ports"].items():
        ports[one["direction"]][name] = one["bits"]
    if ports["inout"]:
        raise NotReadableError("a port of direction inout")
    inputs = {name: net(name, bits) for name, bits in ports["input"].items()}
    nets = reversed(module["netnames"].items())
    shown = {n["bits"][0]: name for name, n in nets if not n.get("hide_name")}
    given = {name: c for name, c in module["cells"].items() if c["type"] not in SILENT}
    made: dict[str, list[Net]] = {}
    for name, cell in given.items():
        kind, wires = cell["type"], cell["connections"]
        given_at = {"$mem_v2": "RD_DATA", "$dff": "Q"}.get(kind, "Y")
        if given_at not in wires or not kind.startswith("$"):
            raise NotReadableError(f"cell {name}: {kind} is not known")
        bits = wires[given_at]
        width = len(bits)
        if kind == "$mem_v2":
            width = _number(cell, "WIDTH")
        words = [bits[k : k + width] for k in range(0, len(bits), width)]
        made[name] = [net(shown.get(one[0], name), one) for one in words]
    outputs = {name: port(bits) for name, bits in ports["output"].items()}
    found, clk = Netlist(inputs, outputs, [], [], []), ((inputs.get("clk"), 0, 1),)
    for name, cell in given.items():
        kind, wires = cell["type"], cell["connections"]
        taken = {k: port(b) for k, b in wires.items() if k not in ("Q", "Y")}
        if kind == "$mem_v2":
            writes = _number(cell, "WR_PORTS")
            if _number(cell, "RD_CLK_ENABLE") or _number(cell, "OFFSET") or writes > 1:
                raise NotReadableError(
                    f"memory {name}: expected reads without a clock, and one write"
                )
            memory, bits = Net(name, _number(cell, "WIDTH")), _number(cell, "ABITS")
            write = tuple(taken[key] for key in ("WR_ADDR", "WR_DATA", "WR_EN"))
            found.memories.append(Memory(memory, _words(cell), write if writes else None))
            for k, output in enumerate(made[name]):
                address = port(wires["RD_ADDR"][k * bits : (k + 1) * bits])
                read = {"A": address, "M": ((memory, 0, memory.width),)}
                found.cells.append(Cell("read", read, output, {}))
            timed, edge = writes == 1, ["WR_CLK", "WR_CLK_ENABLE", "WR_CLK_POLARITY"]
        else:
            signs = {at: _number(cell, f"{at}_SIGNED") == 1 for at in "AB"}
            operator = Cell(kind, taken, made[name][0], signs)
            timed, edge = kind == "$dff", ["CLK", "CLK_POLARITY"]
            (found.registers if timed else found.cells).append(operator)
        if timed and (taken[edge[0]] != clk or any(_number(cell, key) != 1 for key in edge[1:])):
            raise NotReadableError(f"cell {name}: expected the rising edge of clk")
    return found


def _number(cell: dict[str, Any], key: str) -> int:
    return int(cell["parameters"].get(key) or "0", 2)


def _words(cell: dict[str, Any]) -> list[Any]:
    """The words of a memory at the start, X where a bit is not known."""
    width, size = _number(cell, "WIDTH"), _number(cell, "SIZE")
    bits = cell["parameters"]["INIT"].rjust(width * size, "x")
    words = [bits[-width * (k + 1) : len(bits) - width * k] for k in range(size)]
    return [X if set(w) - {"0", "1"} else int(w, 2) for w in words]
