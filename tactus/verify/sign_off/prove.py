"""``make prove BLOCK=``: prove the properties of each block, and refute broken copies.

Three things are asked of each property: that it holds in every clock after reset, whatever drives
the block, or to a stated depth where no induction closes; that what it is about can happen at all;
that every broken copy of the block refutes it. Then the VHDL is proved to be the same function as
the Verilog (``tactus.verify.sign_off.equal``). Answers are kept in the store. A property that
does not hold leaves a counterexample in ``build/prove``. With ``--record`` the proofs are
recorded in ``tactus/verify/sign_off/records``. Without it, a record of anything else is an error.
"""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from tactus.core.cli import stop_if_dry_run
from tactus.core.files import replace_file
from tactus.core.fingerprint import fingerprint
from tactus.core.folders import BUILD
from tactus.core.hold import held
from tactus.core.machine import processor_line, processor_minutes
from tactus.synth.tools import digest
from tactus.verify.benches.collected import CASES_OF, PROOFS, properties_of
from tactus.verify.benches.runner import Job, with_parts
from tactus.verify.sign_off import equal
from tactus.verify.sign_off.record import (
    PROVE,
    case_line,
    chosen_blocks,
    of_another_source,
    recorded,
    subject,
    write_record,
)
from tactus.verify.sign_off.solver import Answer, Inquiry
from tb.common.properties import Property

KIND = "proof"


@dataclass(frozen=True)
class Result:
    job: Job
    item: Property
    answer: Answer
    reached: Answer
    refuted: tuple[Answer, ...]

    @property
    def faults(self) -> list[str]:
        """Why the property is not proved, or why its proof means nothing; empty if all is well."""
        found = []
        if not self.answer.holds:
            found.append(self.answer.failed)
        if not self.reached.holds:
            found.append(f"{self.reached.failed} is not reached in {self.reached.depth} clocks")
        for (pattern, text), answer in zip(self.item.refuted_by, self.refuted, strict=True):
            if answer.holds:
                found.append(f"{pattern} replaced by {text} does not refute it")
        return found

    def line(self) -> str:
        if self.faults:
            return "; ".join(self.faults)
        if self.item.induction:
            clocks = "1 clock" if self.answer.depth == 1 else f"{self.answer.depth} clocks"
            how = f"proved by induction over {clocks}"
        else:
            how = f"holds for {self.answer.depth} clocks from reset"
        return f"{how}, {len(self.refuted)} broken copies refuted"

    def facts(self) -> dict[str, Any]:
        return {**_stated(self.job, self.item), "depth": self.answer.depth}


def _stated(job: Job, item: Property) -> dict[str, Any]:
    """The facts about a property that are known before it is proved."""
    return {
        "case": job.scene.name,
        "entity": job.entity,
        "name": item.name,
        "sentence": item.sentence,
        "assumes": list(item.assumes),
        "free": list(item.free),
        "method": "induction" if item.induction else "depth from reset",
        "refuted_by": len(item.refuted_by),
    }


def settle(job: Job, item: Property) -> Result:
    inquiry = Inquiry(job, item)
    return Result(
        job,
        item,
        inquiry.ask("prove"),
        inquiry.ask("reach") if item.reached else Answer(True, 0),
        tuple(inquiry.ask("refute", n) for n in range(1, len(inquiry.copies))),
    )


def source_of(planned: list[Job]) -> str:
    """A digest of the exported Verilog of entities and their parts."""
    return fingerprint([], *(digest(job.hdl_folder, job.files) for job in planned))


def entities(block: str, export: Callable[[str, str], Job] = subject) -> list[Job]:
    """The entities that stand for a block.

    They are its first entity in the first case of its bench, and in the cases that its proofs name
    in ``PROVED``; each with its parts that have properties, of several alike the first.

    export: Makes the entity from block and case.
    """
    found = []
    for case in cases(block):
        job = export(block, case)
        first = {one.block: one for one in reversed(with_parts(job))}
        found += [job, *(one for one in with_parts(job)[1:] if one in first.values())]
    return [one for one in found if one.block == block or properties_of(one)]


def cases(block: str) -> list[str]:
    return [CASES_OF[block][0], *getattr(PROOFS.get(block), "PROVED", ())]


def check_record(planned: list[Job]) -> list[str]:
    """A message for each way in which a record differs from the block's entities or properties."""
    block = planned[0].block
    stale = of_another_source(KIND, block, source_of(planned))
    found = recorded(KIND, block)
    before = [
        {key: one[key] for key in one if key != "depth"} for one in found.get("properties", [])
    ]
    if found and before != [_stated(job, item) for job in planned for item in properties_of(job)]:
        file = Path(str(PROOFS[block].__file__)).name
        stale.append(
            f"{block}: the record of {KIND} has other properties than {file}; "
            f"run: {PROVE.format(block)}"
        )
    return stale


def prove_blocks(blocks: list[str], record: bool) -> bool:
    """Prove blocks, print a line for each property, and return whether all is as it should be."""
    planned = {block: entities(block) for block in blocks}
    items = [
        (job, item, block)
        for block, jobs in planned.items()
        for job in jobs
        for item in properties_of(job)
    ]
    results: dict[str, list[Result]] = {block: [] for block in blocks}
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        settled = pool.map(lambda asked: settle(*asked[:2]), items)
        for (_, _, block), result in zip(items, settled, strict=True):
            of = f"{result.job.entity} of {result.job.scene.name}"
            print(f"{of:44} {result.item.name:24} {result.line()}", flush=True)
            results[block].append(result)
            if not result.answer.holds:
                print(f"{'':44} counterexample: {_keep_trace(result)}")
    sound = True
    for block, found in results.items():
        faults = any(result.faults for result in found)
        if record and not faults:
            facts = {
                "source": source_of(planned[block]),
                "solver": f"z3 {version('z3-solver')}",
                "properties": [result.facts() for result in found],
            }
            write_record(KIND, block, facts)
        stale = [] if faults else check_record(planned[block])
        for line in stale:
            print(line)
        sound = sound and not faults and not stale
    return sound


def _keep_trace(result: Result) -> Path:
    """Keep the counterexample, and return its file."""
    name = f"{result.job.entity}-{result.item.name.replace(' ', '-')}.vcd"
    trace = BUILD / "prove" / name
    with replace_file(trace) as temporary:
        temporary.write_text(result.answer.trace, encoding="utf-8")
    return trace


def run_blocks(block: str | None, recorded: bool) -> int:
    """Prove the properties of a block or of all, and that VHDL and Verilog are the same."""
    blocks = chosen_blocks(block)
    print(case_line(block), flush=True)
    stop_if_dry_run(f"export and prove {len(blocks)} blocks")
    compared = (case for block in blocks for case in equal.cases(block))
    with held(BUILD / case for case in {*(c for block in blocks for c in cases(block)), *compared}):
        proved = prove_blocks([block for block in blocks if block in PROOFS], recorded)
        properties = processor_minutes()
        print(f"properties: {processor_line(properties)}", flush=True)
        same = equal.prove_equal(blocks, recorded)
        print(f"VHDL and Verilog: {processor_line(processor_minutes() - properties)}")
    return 0 if proved and same else 1
