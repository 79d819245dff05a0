"""Counts the cells of a design in one piece, with the same script for all projects."""

import json
import shutil
import tempfile
from collections import Counter
from pathlib import Path

from tactus.synth.cells import SYNTHESISE, count, script_of
from tactus.synth.tools import run_tool

# The parameters of a module are known only where it is used, so reading it is deferred until then.
SCRIPT = "read_verilog -defer *.v; {}; tee -q -o stat.json stat -json"
# The counts of each kind of ``tactus.synth.cells.KINDS``, by Yosys' names of families.
Cells = dict[str, dict[str, int]]


def in_one_piece(verilog: Path, top: str) -> Cells:
    """The cells of the ``.v`` and ``.mem`` files in a folder, in each family."""
    return {family: _counted(verilog, top, family) for family in SYNTHESISE}


def _counted(verilog: Path, top: str, family: str) -> dict[str, int]:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file in (*verilog.glob("*.v"), *verilog.glob("*.mem")):
            shutil.copy(file, folder)
        flat = script_of(family, folder).replace("synth_xilinx", "synth_xilinx -flatten")
        script = SCRIPT.format(flat.format(family=family, top=top))
        run_tool("yosys", ["-q", "-p", script], folder)
        stat = json.loads((folder / "stat.json").read_text(encoding="utf-8"))["modules"]
    (cells,) = (module["num_cells_by_type"] for module in stat.values())
    return count(Counter(cells))
