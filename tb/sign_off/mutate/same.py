"""Whether a mutant that no bench can tell from the sound netlist is the same, by proof.

Both netlists share whatever the change does not reach. What it reaches is there twice, and
``trigger`` is high where the two differ.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from hdl.synth.tools import run_tool
from tb.sign_off.mutate.mutants import ONE_CHOICE, SELECT, selected

Bit = int | str
Netlist = dict[str, Any]
# Cells that hold state: a change that does not reach the state it leads to is none.
STATE = ("$dff", "$mem_v2")
PROVED = "SAT proof finished - no model found: SUCCESS!"


def flat_netlist(commands: list[str], entity: str, folder: Path) -> Netlist:
    """The whole entity with all of these mutants, each behind a selection of its own."""
    width = len(commands).bit_length()
    lines = ["read_rtlil base.il"]
    lines += [selected(command, width, n) for n, command in enumerate(commands, start=1)]
    lines += [
        ONE_CHOICE,
        f"hierarchy -top {entity}",
        "flatten",
        "memory_collect",
        "dffunmap",
        "opt_clean",
    ]
    lines += ["write_json flat.json"]
    (folder / "flat.ys").write_text("\n".join(lines) + "\n", encoding="utf-8")
    run_tool("yosys", ["-q", "-s", "flat.ys"], folder)
    module: Netlist = json.loads((folder / "flat.json").read_text(encoding="utf-8"))["modules"][
        entity
    ]
    return module


class Flat:
    """A netlist by its bits: what drives and what reads them, and what selects each mutant."""

    def __init__(self, module: Netlist) -> None:
        self.module = module
        self.cells: dict[str, Netlist] = module["cells"]
        self.driver: dict[Bit, str] = {}
        self.readers: dict[Bit, list[str]] = {}
        for name, cell in self.cells.items():
            for bit in _bits(cell, "output"):
                self.driver[bit] = name
            for bit in _bits(cell, "input"):
                self.readers.setdefault(bit, []).append(name)
        select = module["ports"][SELECT]["bits"]
        self.chosen: dict[int, Bit] = {}
        for cell in self.cells.values():
            if cell["type"] == "$eq" and cell["connections"]["A"] == select:
                number = int("".join(reversed(cell["connections"]["B"])), 2)
                self.chosen[number] = cell["connections"]["Y"][0]

    def reached(self, number: int) -> set[str]:
        """The cells whose outputs a mutant may change within the clock."""
        found: set[str] = set()
        waiting = [self.chosen[number]]
        while waiting:
            for name in self.readers.get(waiting.pop(), []):
                if name not in found and self.cells[name]["type"] not in STATE:
                    found.add(name)
                    waiting += _bits(self.cells[name], "output")
        return found

    def ends(self) -> Iterable[list[Bit]]:
        """Where a change shows: outputs, and what enters cells that hold state."""
        yield from (p["bits"] for p in self.module["ports"].values() if p["direction"] == "output")
        yield from (
            list(_bits(cell, "input")) for cell in self.cells.values() if cell["type"] in STATE
        )

    def within_a_clock(self, number: int) -> Netlist:
        """A module whose ``trigger`` is high where an output or the next state differs."""
        twice = self.reached(number)
        control = self.chosen[number]
        constant: dict[Bit, Bit] = dict.fromkeys(self.chosen.values(), "0")
        most = max((b for b in [*self.driver, *self.readers] if isinstance(b, int)), default=1)
        other: dict[Bit, Bit] = {
            bit: most + at
            for at, bit in enumerate(
                (b for name in sorted(twice) for b in _bits(self.cells[name], "output")), start=1
            )
        }
        cells = {
            f"other.{name}": _renamed(self.cells[name], constant | {control: "1"} | other)
            for name in twice
        }
        pairs = sorted({(b, other[b]) for end in self.ends() for b in end if b in other}, key=str)
        # What either copy is made of, up to the state.
        needed: set[str] = set()
        waiting: list[Bit] = [one for one, _ in pairs]
        waiting += [bit for cell in cells.values() for bit in _bits(cell, "input")]
        inputs: set[Bit] = set()
        new = set(other.values())
        while waiting:
            bit = waiting.pop()
            if isinstance(bit, str) or bit in new or bit in constant:
                continue
            name = self.driver.get(bit)
            if name is None or self.cells[name]["type"] in STATE:
                inputs.add(bit)
            elif name not in needed:
                needed.add(name)
                waiting += _bits(self.cells[name], "input")
        cells |= {name: _renamed(self.cells[name], constant) for name in needed}
        trigger = most + len(other) + 1
        cells["differ"] = _differ([a for a, _ in pairs], [b for _, b in pairs], trigger)
        ports = {
            "given": {"direction": "input", "bits": sorted(inputs, key=str)},
            "trigger": {"direction": "output", "bits": [trigger]},
        }
        return {"attributes": {}, "ports": ports, "cells": cells, "netnames": {}}


def _bits(cell: Netlist, direction: str) -> list[Bit]:
    return [
        bit
        for port, bits in cell["connections"].items()
        if cell["port_directions"][port] == direction
        for bit in bits
        if isinstance(bit, int)
    ]


def _renamed(cell: Netlist, names: dict[Bit, Bit]) -> Netlist:
    connections = {p: [names.get(b, b) for b in bits] for p, bits in cell["connections"].items()}
    return cell | {"connections": connections}


def _differ(one: list[Bit], other: list[Bit], output: Bit) -> Netlist:
    width = f"{max(len(one), 1):b}"
    return {
        "hide_name": 0,
        "type": "$ne",
        "parameters": {
            "A_SIGNED": "0",
            "B_SIGNED": "0",
            "A_WIDTH": width,
            "B_WIDTH": width,
            "Y_WIDTH": "1",
        },
        "attributes": {},
        "port_directions": {"A": "input", "B": "input", "Y": "output"},
        "connections": {"A": one or ["0"], "B": other or ["0"], "Y": [output]},
    }


def proved_same(commands: list[str], entity: str, folder: Path) -> list[bool]:
    """Which of the mutants compute the same outputs and the same next state from every state."""
    if not commands:
        return []
    flat = Flat(flat_netlist(commands, entity, folder))
    lines = []
    # One that nothing reads was cleaned away.
    numbers = [number for number in range(1, len(commands) + 1) if number in flat.chosen]
    for number in numbers:
        module = {"creator": "tactus", "modules": {"top": flat.within_a_clock(number)}}
        (folder / f"same{number}.json").write_text(json.dumps(module), encoding="utf-8")
        lines += ["design -reset", f"read_json same{number}.json", "hierarchy -top top", "opt"]
        lines += [f"log mutant {number}", "sat -prove trigger 0 top"]
    (folder / "same.ys").write_text("\n".join(lines) + "\n", encoding="utf-8")
    said = run_tool("yosys", ["-s", "same.ys"], folder)
    answers = dict(zip(numbers, said.split("\nmutant ")[1:], strict=True))
    return [
        number not in answers or PROVED in answers[number] for number in range(1, len(commands) + 1)
    ]
