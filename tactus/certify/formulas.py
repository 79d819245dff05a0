"""Properties of every entity of an export, as questions for z3 about formulas that Yosys writes.

Yosys makes one module of each entity (``flatten.ys``), the property is put into it (``.sv``), and
Yosys writes the transition from one clock to the next as SMT-LIB (``formulas.ys``). The questions
(``.ask``) unroll this transition, as yosys-smtbmc does: that what is assumed can be; that from a
reset on nothing fails in the first clocks; and that after so many clocks without a fault there is
none in the next one. There is a file for each number of clocks, since few are quickly answered and
are mostly enough. Each expression of a property is a question of its own: a graph of adders has
hundreds of them, and to all at once z3 has no answer within hours.
"""

from collections.abc import Callable, Iterable
from pathlib import Path

from tactus.verify.benches.runner import Job, with_parts
from tactus.verify.sign_off.proofs import properties_of
from tactus.verify.sign_off.solver import FLATTEN, formula_script
from tb.common.properties import Property


def write_formulas(jobs: Iterable[Job], folder: Path) -> list[tuple[Job, Property]]:
    """Write ``properties`` below a folder that holds ``design``; the properties by entity."""
    written = []
    place = folder / "properties"
    place.mkdir()
    flatten: list[str] = []
    formulas: list[str] = []
    for job in {one.entity: one for block in jobs for one in with_parts(block)}.values():
        items = properties_of(job)
        if not items:
            continue
        files = " ".join(f"design/verilog/{name}" for name in job.files)
        flatten += ["design -reset", f"read_verilog {files}"]
        flatten += [line.format(top=job.entity) for line in FLATTEN]
        flatten += [f"write_verilog -noattr output/properties/{job.entity}.v"]
        for number, item in enumerate(items, start=1):
            name = f"{job.entity}.{number}"
            formulas += ["design -reset"]
            formulas += formula_script(
                item, job.entity, f"output/properties/{name}.sv", f"output/properties/{name}.smt2"
            )
            text = item.added(clocked="clk" in _inputs(job), reset="rst" in _inputs(job))
            (place / f"{name}.sv").write_text(f"{text}\n", encoding="utf-8")
            for clocks in _depths(item):
                text = _questions(item, job.entity, clocks)
                (place / f"{name}.{clocks:03}.ask").write_text(text, encoding="ascii")
            due = ["sat", *["unsat"] * ((2 if item.induction else 1) * _asserted(item))]
            (place / f"{name}.due").write_text("\n".join([*due, ""]), encoding="ascii")
            written.append((job, item))
    for name, lines in (("flatten", flatten), ("formulas", formulas)):
        (place / f"{name}.ys").write_text("\n".join([*lines, ""]), encoding="utf-8")
    return written


def _depths(item: Property) -> list[int]:
    """Over how many clocks it is asked, until a proof closes."""
    if not item.induction:
        return [item.clocks]
    doubled = (1 << n for n in range(item.induction.bit_length()))
    return sorted({0, item.induction, *(n for n in doubled if n < item.induction)})


def _asserted(item: Property) -> int:
    """The number of expressions that must hold, which Yosys counts from 0."""
    return len(item.states) + len(item.helps)


def _inputs(job: Job) -> set[str]:
    return {port.name for port in job.twin.ports if port.direction == "in"}


def _questions(item: Property, top: str, last: int) -> str:
    """The questions about a property over so many clocks, as SMT-LIB."""

    def states(count: int, first: bool) -> list[str]:
        lines = []
        for n in range(count + 1):
            lines += [f"(declare-fun s{n} () |{top}_s|)"]
            lines += [f"(assert (|{top}_{kind}| s{n}))" for kind in "uh"]
            if n:
                lines.append(f"(assert (|{top}_t| s{n - 1} s{n}))")
            initial = f"(|{top}_is| s{n})"
            lines.append(f"(assert {initial if first and n == 0 else f'(not {initial})'})")
        if first:
            lines.insert(1, f"(assert (|{top}_i| s0))")
        return lines

    def each(fails: Callable[[int], str]) -> list[str]:
        asked = []
        for n in range(_asserted(item)):
            asked += ["(push 1)", f"(assert {fails(n)})", "(check-sat)", "(pop 1)"]
        return asked

    # What is assumed must be possible beyond the clock of the reset.
    clocks = max(1, last)
    lines = ["(push 1)", *states(clocks, first=True), "(check-sat)"]
    lines += each(
        lambda n: f"(or {' '.join(f'(not (|{top}_a {n}| s{m}))' for m in range(clocks + 1))})"
    )
    lines.append("(pop 1)")
    if item.induction:
        lines += ["(push 1)", *states(last, first=False)]
        lines += [f"(assert (|{top}_a| s{m}))" for m in range(last)]
        lines += [*each(lambda n: f"(not (|{top}_a {n}| s{last}))"), "(pop 1)"]
    return "\n".join([*lines, ""])
