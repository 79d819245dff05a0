"""Whether a mutant that no bench finds computes what the sound netlist does, by proof.

First within a clock: the same outputs and the same next state, from every state. Where that does
not hold, over clocks, from registers that are 0 and a clock of reset on: the same outputs and the
same next state still, from every state that the sound netlist reaches; or else the same outputs for
ever. Data is compared where its flag says that it counts. That is done by ABC, which Yosys has
inside: signals that are the same are found by induction (scorr), the rest by property-directed
reachability (pdr), which also finds inputs that tell the two apart. All are bounded by conflicts
and clocks, but over clocks by processor time as well, which other work on the machine does not use
up: a slower processor may leave open what this one proves, and score less. What is too large for
that is left open at once.

All mutants stand in one netlist of the entity with its parts, each behind a selection. Whatever a
mutant does not reach is shared between the sound netlist and the changed one; what it reaches is
there twice, and ``trigger`` is high where the two differ.
"""

from __future__ import annotations

import itertools
import json
import os
from collections.abc import Collection, Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from tactus.synth.tools import run_tool
from tactus.verify.sign_off.mutate.mutants import ONE_CHOICE, SELECT

SAME, OTHER, OPEN = "same", "other", "open"
CONFLICTS, CLOCKS = 20_000, 400
SECONDS = (10, 600)
# Of more bits in registers and memories nothing is shown over clocks in so little time.
STORED = 2000
ANSWERS = {"snl_UNSAT": SAME, "snl_SAT": OTHER, "snl_UNK": OPEN}
# What gives an AIG's registers their first values, and its memories registers.
STEPS = ["setundef -init -zero", "opt", "memory_map", "setundef -init -zero", "opt -full"]
STEPS += ["techmap", "opt", "dffunmap", "simplemap"]
# Yosys gives ABC something to work on; the files it reads have nothing to do with that.
NOTHING = "module nothing(input a, b, output y); assign y = a & b; endmodule\n"


def proved(
    commands: list[str],
    entity: str,
    folder: Path,
    masks: dict[str, str],
    explained: Collection[int] = (),
) -> list[str]:
    """Of each mutant whether it is the same, another, or neither is proved.

    Those that are ``explained``, by number from 1, are looked at within a clock alone.
    """
    if not commands:
        return []
    flat = flatten(commands, entity, folder)
    # What nothing reads is the same, and so is what differs from no state within a clock.
    answers = dict.fromkeys(range(1, len(commands) + 1), SAME)
    asked = [n for n, verdict in _within_a_clock(flat, folder).items() if verdict != SAME]

    def work(n: int) -> str:
        return OPEN if n in explained else _over_clocks(flat, n, masks, folder)

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        answers |= zip(asked, pool.map(work, asked), strict=True)
    return list(answers.values())


def _within_a_clock(flat: Flat, folder: Path) -> dict[int, str]:
    """What is shown of each mutant that something reads, by number from 1."""
    numbers = sorted(flat.chosen)
    prepared = [
        _write(flat.within_a_clock(n), folder, f"within{n}", ["opt", "techmap", "opt"])
        for n in numbers
    ]
    work = f"strash;fraig,-C,1000;write_aiger,{{0}}.left.aig;dsat,-C,{CONFLICTS}"
    verdicts = ask(prepared, [f"within{n}" for n in numbers], work, folder)
    return dict(zip(numbers, verdicts, strict=True))


def _over_clocks(flat: Flat, number: int, masks: dict[str, str], folder: Path) -> str:
    """What can be shown of one: that no state ever differs or, which alone is final, no output."""
    products = {"states": flat.from_reset, "outputs": flat.over_clocks}
    prepared: dict[str, list[str]] = {}
    for seconds in SECONDS:
        for kind, product in list(products.items()):
            name = f"{kind}{number}"
            if kind not in prepared:
                module = product(number, masks)
                if stored_bits(module) > STORED:
                    del products[kind]
                    continue
                prepared[kind] = _write(module, folder, name, STEPS)
            work = f"scorr,-F,2;write_aiger,{{0}}.left.aig;pdr,-C,{CONFLICTS},-F,{CLOCKS}"
            verdict = ask([prepared[kind]], [name], work, folder, seconds)[0]
            if verdict == SAME or (verdict == OTHER and kind == "outputs"):
                return verdict
            if verdict == OTHER:
                del products[kind]
    return OPEN


def _write(module: Netlist, folder: Path, name: str, steps: list[str]) -> list[str]:
    """Write a module; the commands that make an AIG of it."""
    text = json.dumps({"creator": "tactus", "modules": {"top": module}})
    (folder / f"{name}.json").write_text(text, encoding="utf-8")
    read = ["design -reset", f"read_json {name}.json", "hierarchy -top top"]
    return [*read, *steps, "setundef -zero", "aigmap", "opt_clean", f"write_aiger {name}.aig"]


def ask(
    prepared: list[list[str]], names: list[str], work: str, folder: Path, seconds: int | None = None
) -> list[str]:
    """Whether ``trigger`` can rise in each AIG; ``work`` is what ABC does with it.

    All of it ends after so many ``seconds`` of processor time, if that is given.
    """
    if not names:
        return []
    asked = [f"read_aiger,{n}.aig;{work.format(n)};write_status,{n}.txt" for n in names]
    nothing, script = (folder / f"{names[0]}.{kind}" for kind in ("v", "ys"))
    nothing.write_text(NOTHING, encoding="utf-8")
    lines = [line for part in prepared for line in part]
    lines += ["design -reset", f"read_verilog {nothing.name}", "simplemap"]
    lines += [f"abc -script +backup;{';'.join(asked)};restore;strash;map"]
    script.write_text("\n".join(lines) + "\n", encoding="utf-8")
    run_tool("yosys", ["-q", "-s", script.name], folder, seconds=seconds)
    return [_verdict(folder, name) for name in names]


def _verdict(folder: Path, name: str) -> str:
    """From what is left of the netlist, where that never rises, or from the last that was done.

    That says nothing where its time was over.
    """
    status = folder / f"{name}.txt"
    said = status.read_text(encoding="utf-8").split() if status.exists() else []
    if not said:
        return OPEN
    lines = (folder / f"{name}.left.aig").read_bytes().split(b"\n")
    latches = int(lines[0].split()[3])
    return SAME if lines[1 + latches] == b"0" else ANSWERS[said[0]]


Bit = int | str
Netlist = dict[str, Any]
# Bits that are compared, and the bit that says when they count.
End = tuple[list[Bit], Bit | None]
STATE = ("$dff", "$mem_v2")
# Yosys takes out a comparison of a single bit with 1, because that is the bit itself.
NARROWEST = 2


def flatten(commands: list[str], entity: str, folder: Path) -> Flat:
    """The entity with all of these mutants, each behind a selection of its own.

    A selection that is missing in the end is one that nothing reads: all are there before
    ``opt_clean``, which takes out nothing else.
    """
    width = max(NARROWEST, len(commands).bit_length())
    lines = ["read_rtlil base.il"]
    for n, command in enumerate(commands, start=1):
        lines.append(f"mutate -ctrl {SELECT} {width} {n} {command.removeprefix('mutate ')}")
    lines += [ONE_CHOICE, f"hierarchy -top {entity}", "flatten", "memory_collect", "dffunmap"]
    # A part that is there twice has two selections of the same mutant.
    lines += ["opt_merge t:$eq"]
    # What only carries below a rounding then has no reader.
    lines += ["opt_expr -fine"]
    lines += [f"select -assert-count {len(commands)} c:*mutate_ctrl* t:$eq %i"]
    lines += ["opt_clean", "write_json flat.json"]
    (folder / "flat.ys").write_text("\n".join(lines) + "\n", encoding="utf-8")
    run_tool("yosys", ["-q", "-s", "flat.ys"], folder)
    return Flat(json.loads((folder / "flat.json").read_text(encoding="utf-8"))["modules"][entity])


class Flat:
    """A netlist by its bits: what drives and what reads them, and what selects each mutant."""

    def __init__(self, module: Netlist) -> None:
        self.ports: dict[str, Netlist] = module["ports"]
        self.cells: dict[str, Netlist] = module["cells"]
        self.driver: dict[Bit, str] = {}
        self.readers: dict[Bit, list[str]] = {}
        for name, cell in self.cells.items():
            for bit in bits_of(cell, "output"):
                self.driver[bit] = name
            for bit in bits_of(cell, "input"):
                self.readers.setdefault(bit, []).append(name)
        select = self.ports[SELECT]["bits"]
        # One that nothing reads was cleaned away (see ``flatten``).
        self.chosen: dict[int, Bit] = {}
        for cell in self.cells.values():
            if cell["type"] == "$eq" and cell["connections"]["A"] == select:
                number = int("".join(reversed(cell["connections"]["B"])), 2)
                self.chosen[number] = cell["connections"]["Y"][0]

    def within_a_clock(self, number: int) -> Netlist:
        """A mutant's ``trigger``: an output or the next state differs, from whatever state."""
        return self._product(number, self._ends({}, True), STATE, self._reached(number, STATE))

    def from_reset(self, number: int, masks: dict[str, str]) -> Netlist:
        """A mutant's ``trigger``: an output or the next state differs, as the sound netlist runs.

        That runs from a first clock of reset on. Where none ever differs, the mutant has the same
        states, so that what is behind the first registers takes no part.
        """
        twice = self._reached(number, STATE)
        product = self._product(number, self._ends(masks, True), (), twice)
        return self._reset_first(product, counts=True)

    def over_clocks(self, number: int, masks: dict[str, str]) -> Netlist:
        """A mutant's ``trigger``: an output differs, after a first clock of reset."""
        product = self._product(number, self._ends(masks, False), (), self._reached(number, ()))
        return self._reset_first(product, counts=False)

    def _ends(self, masks: dict[str, str], state: bool) -> list[End]:
        """The outputs, of which some count only with a flag, by ``masks``; and, of the next
        ``state``, the inputs of registers and memories, without register bits that nothing reads.
        """
        outputs = {n: p["bits"] for n, p in self.ports.items() if p["direction"] == "output"}
        ends: list[End] = [
            (bits, outputs[masks[name]][0] if name in masks else None)
            for name, bits in outputs.items()
        ]
        read = {*self.readers, *(bit for bits in outputs.values() for bit in bits)}
        for cell in self.cells.values() if state else ():
            ports = cell["connections"]
            if cell["type"] == "$dff":
                pairs = zip(ports["D"], ports["Q"], strict=True)
                ends.append(([*ports["CLK"], *(d for d, q in pairs if q in read)], None))
            elif cell["type"] in STATE:
                ends.append((bits_of(cell, "input"), None))
        return ends

    def _product(
        self, number: int, ends: list[End], shared: tuple[str, ...], twice: set[str]
    ) -> Netlist:
        """The netlist, with some cells ``twice``: as they are and as the mutant changes them.

        It ends at cells of the ``shared`` kinds, whose outputs are inputs here.
        """
        control = self.chosen[number]
        most = max((b for b in [*self.driver, *self.readers] if isinstance(b, int)), default=1)
        new = itertools.count(most + 1)
        sound: dict[Bit, Bit] = dict.fromkeys(self.chosen.values(), "0")
        changed: dict[Bit, Bit] = {
            bit: next(new) for name in sorted(twice) for bit in bits_of(self.cells[name], "output")
        }
        cells: dict[str, Netlist] = {}
        asked: list[Bit] = []
        differ: list[Bit] = []
        for bits, flag in ends:
            pairs = [(bit, changed[bit]) for bit in dict.fromkeys(bits) if bit in changed]
            if pairs:
                found = next(new)
                cells[f"differ.{found}"] = _cell("$ne", found, *map(list, zip(*pairs, strict=True)))
                asked += [bit for bit, _ in pairs]
                if flag is not None:
                    asked.append(flag)
                    counts = next(new)
                    cells[f"counts.{counts}"] = _cell("$and", counts, [found], [flag])
                    found = counts
                differ.append(found)
        needed, inputs = self._made_of(asked, shared)
        for name in needed:
            cells[name] = _renamed(self.cells[name], sound)
            if name in twice:
                copy = _renamed(self.cells[name], sound | {control: "1"} | changed)
                if "MEMID" in copy["parameters"]:
                    copy["parameters"] = copy["parameters"] | {"MEMID": f"\\other.{name}"}
                cells[f"other.{name}"] = copy
        trigger = next(new)
        cells["any"] = _cell("$reduce_or", trigger, differ or ["0"])
        ports = {
            "given": {"direction": "input", "bits": inputs},
            "trigger": {"direction": "output", "bits": [trigger]},
        }
        return {"attributes": {}, "ports": ports, "cells": cells, "netnames": {}}

    def _reset_first(self, product: Netlist, counts: bool) -> Netlist:
        """The product, reset in the first clock; its trigger counts in it or not."""
        if "rst" not in self.ports:
            return product
        clock, reset = (self.ports[name]["bits"] for name in ("clk", "rst"))
        cells, ports = product["cells"], product["ports"]
        found = ports["trigger"]["bits"]
        started, begins, forced, trigger = (found[0] + n for n in range(1, 5))
        for name, cell in cells.items():
            cells[name] = _renamed(cell, {reset[0]: forced})
        cells["started"] = {
            "hide_name": 0,
            "type": "$dff",
            "parameters": {"CLK_POLARITY": "1", "WIDTH": "1"},
            "attributes": {},
            "port_directions": {"CLK": "input", "D": "input", "Q": "output"},
            "connections": {"CLK": clock, "D": ["1"], "Q": [started]},
        }
        cells["begins"] = _cell("$not", begins, [started])
        cells["forced"] = _cell("$or", forced, reset, [begins])
        ports["given"]["bits"] = sorted({*ports["given"]["bits"], *clock, *reset})
        if not counts:
            cells["counts"] = _cell("$and", trigger, found, [started])
            ports["trigger"]["bits"] = [trigger]
        return product

    def _reached(self, number: int, shared: tuple[str, ...]) -> set[str]:
        """The cells whose outputs may hang on whether a mutant is chosen."""
        found: set[str] = set()
        waiting = [self.chosen[number]]
        while waiting:
            for name in self.readers.get(waiting.pop(), []):
                if name not in found and self.cells[name]["type"] not in shared:
                    found.add(name)
                    waiting += bits_of(self.cells[name], "output")
        return found

    def _made_of(self, asked: list[Bit], shared: tuple[str, ...]) -> tuple[set[str], list[Bit]]:
        """The cells that some bits come from, and the bits that no cell here drives."""
        needed: set[str] = set()
        inputs: set[int] = set()
        waiting = list(asked)
        while waiting:
            bit = waiting.pop()
            if isinstance(bit, str) or bit in self.chosen.values():
                continue
            name = self.driver.get(bit)
            if name is None or self.cells[name]["type"] in shared:
                inputs.add(bit)
            elif name not in needed:
                needed.add(name)
                waiting += bits_of(self.cells[name], "input")
        return needed, sorted(inputs)


def bits_of(cell: Netlist, direction: str) -> list[Bit]:
    """The bits on a cell's inputs or outputs."""
    return [
        bit
        for port, bits in cell["connections"].items()
        if cell["port_directions"][port] == direction
        for bit in bits
        if isinstance(bit, int)
    ]


def stored_bits(netlist: Netlist) -> int:
    """How many bits its registers and memories hold."""
    found = 0
    for cell in netlist["cells"].values():
        given = cell["parameters"]
        if cell["type"] == "$dff":
            found += len(cell["connections"]["Q"])
        elif cell["type"] == "$mem_v2":
            found += int(given["SIZE"], 2) * int(given["WIDTH"], 2)
    return found


def _renamed(cell: Netlist, names: dict[Bit, Bit]) -> Netlist:
    connections = {p: [names.get(b, b) for b in bits] for p, bits in cell["connections"].items()}
    return cell | {"connections": connections}


def _cell(kind: str, output: Bit, *inputs: Iterable[Bit]) -> Netlist:
    connections = dict(zip("AB", map(list, inputs), strict=False))
    parameters = {"Y_WIDTH": "1"}
    for port, bits in connections.items():
        parameters |= {f"{port}_SIGNED": "0", f"{port}_WIDTH": f"{len(bits):b}"}
    return {
        "hide_name": 0,
        "type": kind,
        "parameters": parameters,
        "attributes": {},
        "port_directions": {**dict.fromkeys(connections, "input"), "Y": "output"},
        "connections": {**connections, "Y": [output]},
    }
