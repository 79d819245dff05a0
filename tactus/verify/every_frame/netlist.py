"""The hardware as Yosys reads it: words and operators, before anything is optimised.

What is trusted here is Yosys' reading of the language. Every port of a cell is kept as runs of bits
of words, so that the rest never meets a single wire.
"""

import json
import shutil
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

READ = "hierarchy -check -top {top}; proc; flatten; memory_collect; opt_clean"
# What these say concerns simulation and properties, not what the hardware does.
SILENT = "$scopeinfo", "$print", "$check", "$assert", "$assume", "$cover"


class NotReadableError(Exception):
    """Hardware that cannot be read, with the reason."""


@dataclass(frozen=True)
class Run:
    """Bits of a word from `low` on, or known bits (`word` is None; `bits` None where they are not
    known)."""

    word: int | None
    low: int
    count: int
    bits: int | None = None


Runs = tuple[Run, ...]


class Cell(NamedTuple):
    """An operator, a register ("$dff"), or a "read" at A of M, the words of a memory."""

    kind: str
    inputs: dict[str, Runs]
    output: int
    signed: dict[str, bool]


class Memory(NamedTuple):
    """All words of a memory are one word of the netlist. At the `start` those are None that are not
    known. A write has address, data, and an enable of each bit."""

    words: int
    start: list[int | None]
    write: tuple[Runs, ...] | None


class Netlist(NamedTuple):
    widths: list[int]
    names: list[str]
    inputs: dict[str, int]
    outputs: dict[str, Runs]
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
    home: dict[int, tuple[int, int]] = {}
    widths: list[int] = []
    names: list[str] = []

    def word(name: str, bits: list[Any]) -> int:
        for k, bit in enumerate(bits):
            if isinstance(bit, int):
                if bit in home:
                    raise NotReadableError(f"{name}: a wire with two drivers")
                home[bit] = len(widths), k
        widths.append(len(bits))
        names.append(name)
        return len(widths) - 1

    def runs(bits: list[Any]) -> Runs:
        found: list[Run] = []
        for bit in bits:
            # A wire that nothing drives is unknown.
            known, last = {"0": 0, "1": 1}.get(bit), found[-1] if found else Run(-1, 0, 0)
            source, place = home.get(bit, (None, 0))
            if source is None:
                if last.word is None and (last.bits is None) == (known is None):
                    bits_of = known if known is None else last.bits | known << last.count  # type: ignore[operator]
                    found[-1] = Run(None, 0, last.count + 1, bits_of)
                else:
                    found.append(Run(None, 0, 1, known))
            elif (last.word, last.low + last.count) == (source, place):
                found[-1] = Run(source, last.low, last.count + 1)
            else:
                found.append(Run(source, place, 1))
        return tuple(found)

    ports: dict[str, dict[str, list[Any]]] = {"input": {}, "output": {}, "inout": {}}
    for name, port in module["ports"].items():
        ports[port["direction"]][name] = port["bits"]
    if ports["inout"]:
        raise NotReadableError("a port of direction inout")
    inputs = {name: word(name, bits) for name, bits in ports["input"].items()}
    nets = reversed(module["netnames"].items())
    shown = {n["bits"][0]: name for name, n in nets if not n.get("hide_name")}
    given = {name: c for name, c in module["cells"].items() if c["type"] not in SILENT}
    made: dict[str, list[int]] = {}
    for name, cell in given.items():
        kind, wires = cell["type"], cell["connections"]
        port = {"$mem_v2": "RD_DATA", "$dff": "Q"}.get(kind, "Y")
        if port not in wires or not kind.startswith("$"):
            raise NotReadableError(f"cell {name}: {kind} is not known")
        width = _number(cell["parameters"]["WIDTH"]) if kind == "$mem_v2" else len(wires[port])
        pieces = [wires[port][k : k + width] for k in range(0, len(wires[port]), width)]
        made[name] = [word(shown.get(piece[0], name), piece) for piece in pieces]
    outputs = {name: runs(bits) for name, bits in ports["output"].items()}
    found = Netlist(widths, names, inputs, outputs, [], [], [])
    for name, cell in given.items():
        kind, wires, parameters = cell["type"], cell["connections"], cell["parameters"]
        if kind == "$mem_v2":
            start, write = _memory(name, parameters, wires)
            width = _number(parameters["WIDTH"])
            words = word(name, ["x"] * width)
            found.memories.append(Memory(words, start, write and tuple(map(runs, write))))
            bits = _number(parameters["ABITS"])
            for k, output in enumerate(made[name]):
                address = runs(wires["RD_ADDR"][k * bits : (k + 1) * bits])
                ports_of = {"A": address, "M": (Run(words, 0, width),)}
                found.cells.append(Cell("read", ports_of, output, {}))
            continue
        taken = {p: runs(b) for p, b in wires.items() if p not in "QY"}
        signs = {p: _number(parameters.get(f"{p}_SIGNED", 0)) == 1 for p in "AB"}
        one = Cell(kind, taken, made[name][0], signs)
        if kind != "$dff":
            found.cells.append(one)
        elif taken["CLK"] == (Run(inputs.get("clk", -1), 0, 1),) and _number(
            parameters["CLK_POLARITY"]
        ):
            found.registers.append(one)
        else:
            raise NotReadableError(f"register {names[one.output]}: expected the rising edge of clk")
    return found


def _number(text: Any) -> int:
    return text if isinstance(text, int) else int(text, 2)


def _memory(name: str, given: dict[str, Any], wires: dict[str, list[Any]]) -> Any:
    """The words of a memory at the start, and the bits of its write, if there is one."""
    width, size, writes = (_number(given[key]) for key in ("WIDTH", "SIZE", "WR_PORTS"))
    if _number(given["RD_CLK_ENABLE"]):
        raise NotReadableError(f"memory {name}: expected reads without a clock")
    if _number(given["OFFSET"]) or writes > 1:
        raise NotReadableError(f"memory {name}: expected addresses from 0 on, and one write")
    if writes and not _number(given["WR_CLK_ENABLE"]) & _number(given["WR_CLK_POLARITY"]):
        raise NotReadableError(f"memory {name}: expected writes at the rising edge of clk")
    init = given["INIT"].rjust(width * size, "x")
    words = [init[len(init) - width * (k + 1) : len(init) - width * k] for k in range(size)]
    start = [None if set(w) - {"0", "1"} else int(w, 2) for w in words]
    return start, [wires[port] for port in ("WR_ADDR", "WR_DATA", "WR_EN")] if writes else None
