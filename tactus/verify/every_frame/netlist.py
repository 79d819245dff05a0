"""The hardware as Yosys reads it: words and operators, before anything is optimised.

What is trusted here is Yosys' reading of the language. Every port of a cell is kept as runs of bits
of words, so that the rest never meets a single wire.
"""

import json
import shutil
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

READ = "hierarchy -check -top {top}; proc; flatten; memory_collect; opt_clean"
REGISTERS = "$dff", "$dffe", "$sdff", "$sdffe", "$sdffce"
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


@dataclass
class Cell:
    name: str
    kind: str
    parameters: dict[str, int]
    inputs: dict[str, tuple[Run, ...]]
    output: int
    width: int

    def flag(self, name: str) -> bool:
        return self.parameters.get(name, 0) == 1


@dataclass
class Memory:
    """Words of `width` bits at addresses from `offset`; writes are (address, data, enable of each
    bit)."""

    name: str
    width: int
    size: int
    offset: int
    start: list[int | None]
    reads: list[tuple[tuple[Run, ...], int]] = field(default_factory=list)
    writes: list[tuple[tuple[Run, ...], tuple[Run, ...], tuple[Run, ...]]] = field(
        default_factory=list
    )


@dataclass
class Netlist:
    widths: list[int]
    inputs: dict[str, int]
    outputs: dict[str, tuple[Run, ...]]
    cells: list[Cell]
    registers: list[Cell]
    memories: list[Memory]
    names: list[str]


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

    def number(text: Any) -> int:
        return (
            text
            if isinstance(text, int)
            else int(text.replace("x", "0").replace("z", "0") or "0", 2)
        )

    inputs = {
        n: word(n, p["bits"]) for n, p in module["ports"].items() if p["direction"] == "input"
    }
    if any(p["direction"] == "inout" for p in module["ports"].values()):
        raise NotReadableError("a port of direction inout")
    shown = {
        bits[0]: n
        for n, w in reversed(module["netnames"].items())
        if isinstance((bits := w["bits"])[0], int) and not w.get("hide_name")
    }
    made = {}
    for name, cell in module["cells"].items():
        kind, wires = cell["type"], cell["connections"]
        if kind in SILENT:
            continue
        if kind == "$mem_v2":
            width = number(cell["parameters"]["WIDTH"])
            data = wires["RD_DATA"]
            made[name] = [
                word(f"{name} read {k}", data[k * width : (k + 1) * width])
                for k in range(len(data) // width)
            ]
            continue
        port = "Q" if kind in REGISTERS else "Y"
        if port not in wires or not kind.startswith("$"):
            raise NotReadableError(f"cell {name}: {kind} is not known")
        made[name] = [word(shown.get(wires[port][0], name), wires[port])]

    def runs(bits: list[Any]) -> tuple[Run, ...]:
        found: list[Run] = []
        for bit in bits:
            last = found[-1] if found else None
            if isinstance(bit, str) or bit not in home:
                # A wire that nothing drives is unknown.
                known = {"0": 0, "1": 1}.get(bit)
                if last and last.word is None and last.bits is None and known is None:
                    found[-1] = Run(None, 0, last.count + 1)
                elif last and last.bits is not None and known is not None:
                    found[-1] = Run(None, 0, last.count + 1, last.bits | known << last.count)
                else:
                    found.append(Run(None, 0, 1, known))
                continue
            source, place = home[bit]
            if last and last.word == source and last.low + last.count == place:
                found[-1] = Run(source, last.low, last.count + 1)
            else:
                found.append(Run(source, place, 1))
        return tuple(found)

    cells, registers, memories = [], [], []
    for name, cell in module["cells"].items():
        kind, wires, given = cell["type"], cell["connections"], cell["parameters"]
        if kind in SILENT:
            continue
        if kind == "$mem_v2":
            memories.append(
                _memory(
                    name,
                    {k: number(v) for k, v in given.items() if k not in ("INIT", "MEMID")},
                    given["INIT"],
                    wires,
                    runs,
                    made[name],
                )
            )
            continue
        parameters = {k: number(v) for k, v in given.items()}
        port = "Q" if kind in REGISTERS else "Y"
        found = Cell(
            name,
            kind,
            parameters,
            {p: runs(b) for p, b in wires.items() if p != port},
            made[name][0],
            len(wires[port]),
        )
        if port == "Q":
            if found.inputs["CLK"] != (Run(inputs.get("clk", -1), 0, 1),) or not found.flag(
                "CLK_POLARITY"
            ):
                raise NotReadableError(
                    f"register {names[made[name][0]]}: expected the rising edge of clk"
                )
            registers.append(found)
        else:
            cells.append(found)
    outputs = {n: runs(p["bits"]) for n, p in module["ports"].items() if p["direction"] == "output"}
    return Netlist(widths, inputs, outputs, cells, registers, memories, names)


def _memory(
    name: str,
    p: dict[str, int],
    init: str,
    wires: dict[str, list[Any]],
    runs: Any,
    reads: list[int],
) -> Memory:
    width, size, bits = p["WIDTH"], p["SIZE"], p["ABITS"]
    if p["RD_CLK_ENABLE"]:
        raise NotReadableError(f"memory {name}: expected reads without a clock")
    if wires["WR_CLK"] and (
        len(set(wires["WR_CLK"])) > 1
        or p["WR_CLK_ENABLE"] != (1 << p["WR_PORTS"]) - 1
        or p["WR_CLK_POLARITY"] != p["WR_CLK_ENABLE"]
    ):
        raise NotReadableError(f"memory {name}: expected writes at the rising edge of one clock")
    init = init.rjust(width * size, "x")
    words = [init[len(init) - width * (k + 1) : len(init) - width * k] for k in range(size)]

    def cut(port: str, k: int, n: int) -> tuple[Run, ...]:
        found: tuple[Run, ...] = runs(wires[port][k * n : (k + 1) * n])
        return found

    found = Memory(
        name, width, size, p["OFFSET"], [None if set(w) - {"0", "1"} else int(w, 2) for w in words]
    )
    found.reads = [(cut("RD_ADDR", k, bits), output) for k, output in enumerate(reads)]
    found.writes = [
        (cut("WR_ADDR", k, bits), cut("WR_DATA", k, width), cut("WR_EN", k, width))
        for k in range(p["WR_PORTS"])
    ]
    return found
