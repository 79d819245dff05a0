"""The proofs of a certificate, as files that Yosys, z3 and Python check without tactus.

Equality: VHDL and Verilog are the same functions; the assumptions are those of
``tactus.verify.sign_off.equal``.

Properties: Yosys makes one module of each entity (``flatten.ys``), the property is put into it
(``.sv``), and Yosys writes the transition from one clock to the next as SMT-LIB (``formulas.ys``).
The questions (``.ask``) unroll this transition, as yosys-smtbmc does: that what is assumed can be;
that from a reset on nothing fails in the first clocks; and that after so many clocks without a
fault there is none in the next one. There is a file for each number of clocks, since few are
quickly answered and are mostly enough. Each expression of a property is a question of its own,
which z3 answers far sooner than all of them at once.

Every frame: the prover, and what it proves the delivered hardware to compute.
"""

import json
import re
import shutil
import subprocess
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from tactus.core.closure import closure
from tactus.core.fingerprint import ROOT
from tactus.core.templates import environment
from tactus.export.exporter import compile_order
from tactus.scene import Scene
from tactus.verify.benches.collected import properties_of
from tactus.verify.benches.runner import Job, with_parts
from tactus.verify.every_frame.specify import description
from tactus.verify.sign_off.equal import WRITES, WRITES_TEXT, proof_script
from tactus.verify.sign_off.equal_netlist import dump, read_dump, to_verilog
from tactus.verify.sign_off.solver import FLATTEN, formula_script
from tb.common.properties import Property

# A comment says from which line of VHDL a gate is.
_COMMENT = re.compile(r"^ *#.*\n", re.MULTILINE)
NETLIST = "netlist.txt"


def write_equality(folder: Path, top: str) -> None:
    """Write ``equal`` below a folder that holds ``design``."""
    vhdl, verilog, equal = folder / "design/vhdl", folder / "design/verilog", folder / "equal"
    equal.mkdir()
    sources = [vhdl / name for name in compile_order(vhdl)]
    text = _COMMENT.sub("", dump(sources, top))
    modules = read_dump(text, sources)
    said = subprocess.run(["ghdl", "--version"], capture_output=True, text=True, check=True)
    files = {NETLIST: text, "ghdl.txt": f"{said.stdout.splitlines()[0]}\n", WRITES: WRITES_TEXT}
    for file in compile_order(verilog):
        entity = Path(file).stem
        files[file] = to_verilog(modules[entity])
        files[f"{entity}.ys"] = proof_script(
            entity,
            (verilog / file).read_text(encoding="utf-8"),
            (f"design/verilog/{file}", f"equal/{file}"),
            [f"design/verilog/{part}.v" for part in sorted(modules[entity].children())],
            f"equal/{WRITES}",
        )
    for name, text in files.items():
        (equal / name).write_text(text, encoding="utf-8")


def write_formulas(jobs: Iterable[Job], folder: Path) -> list[tuple[Job, Property]]:
    """Write ``properties`` below a folder that holds ``design``; the properties by entity."""
    written = []
    template = environment("tactus.certify").get_template("questions.smt2.jinja")
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
            inputs = {port.name for port in job.twin.ports if port.direction == "in"}
            text = item.added(clocked="clk" in inputs, reset="rst" in inputs)
            (place / f"{name}.sv").write_text(f"{text}\n", encoding="utf-8")
            # The expressions that must hold, which Yosys counts from 0.
            asserted = len(item.states) + len(item.helps)
            for clocks in _depths(item):
                text = template.render(
                    top=job.entity, last=clocks, asserted=asserted, induction=item.induction
                )
                (place / f"{name}.{clocks:03}.ask").write_text(text, encoding="ascii")
            due = ["sat", *["unsat"] * ((2 if item.induction else 1) * asserted)]
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


NETWORK, REFUSED = "network.json", "refused.txt"
_PACKAGES = ["tactus", "tactus.verify", "tactus.verify.every_frame"]
PROVER = '''"""Runs the prover beside this file: prover.py network.json netlist.json."""

import sys

from tactus.verify.every_frame.verdict import main

sys.exit(main())
'''


def write_every_frame(scene: Scene, folder: Path) -> None:
    """Write ``every_frame`` below a folder; without a network, why it cannot be proved."""
    place = folder / "every_frame"
    place.mkdir()
    try:
        text = readable(description(scene))
    except InputError as reason:
        (place / REFUSED).write_text(f"{reason}\n", encoding="utf-8")
        return
    (place / NETWORK).write_text(text, encoding="utf-8")
    (place / "prover.py").write_text(PROVER, encoding="utf-8")
    for module in closure([f"{_PACKAGES[-1]}.verdict", *_PACKAGES]).values():
        target = place / module.relative_to(ROOT)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(module, target)


def readable(given: dict[str, Any]) -> str:
    """The network as JSON: a line for each table, and one with its number for each word."""
    numbered = [{"word": given["samples"] + n, **word} for n, word in enumerate(given["words"])]
    many = {
        "tables": [f"{json.dumps(k)}: {json.dumps(v)}" for k, v in given["tables"].items()],
        "words": [json.dumps(word) for word in numbered],
    }
    entries = []
    for key, value in given.items():
        text, rows = json.dumps(value), ",\n  ".join(many.get(key, []))
        entries.append(f'"{key}": ' + (f"{text[0]}\n  {rows}\n {text[-1]}" if rows else text))
    return "{\n " + ",\n ".join(entries) + "\n}\n"
