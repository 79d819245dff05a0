"""``python -m hdl.cells``: what each activation costs, by Yosys, with no segment left out."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

from golden.activation.activation_block import ActivationBlock
from golden.activation.schemes import forms
from golden.cli import CommandError, run
from golden.networks.network import Network
from golden.precision import PRECISE
from hdl.elaborate import elaborate, elaborate_activation
from hdl.hierarchy import convert_hierarchy

# Yosys' name of the family, and what it is.
FAMILIES = {"xc2v": "Virtex-II, LUT of 4 inputs", "xc7": "Series 7, LUT of 6 inputs"}
# What is counted, by the beginnings of Yosys' cell names. A shift register sits in a LUT; an
# inverter is usually absorbed by what is behind it and stands by itself.
KINDS = {
    "LUT": ("LUT", "SRL"),
    "inverter": ("INV",),
    "flip-flop": ("FD",),
    "multiplier": ("MULT", "DSP"),
    "block RAM": ("RAMB",),
}


def cells(spec: ActivationBlock | Network, family: str) -> dict[str, int]:
    """Cells of an activation or a network, with its parts, after ``synth_xilinx``.

    Raises
    ------
    CommandError
        When Yosys is not installed or fails.
    """
    if not shutil.which("yosys"):
        raise CommandError("not installed: yosys; run: sudo apt-get install yosys")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        elaborated = elaborate(spec) if isinstance(spec, Network) else elaborate_activation(spec)
        convert_hierarchy(elaborated, folder, "verilog")
        script = (
            f"read_verilog *.v; synth_xilinx -family {family} -noiopad -noclkbuf "
            f"-top {spec.entity}; flatten; tee -q -o stat.json stat -json"
        )
        result = subprocess.run(
            ["yosys", "-q", "-p", script], cwd=folder, capture_output=True, text=True, check=False
        )
        if result.returncode:
            raise CommandError(f"yosys: {spec.entity}, {family}: {result.stderr.strip()}")
        counts: Counter[str] = json.loads((folder / "stat.json").read_text())["design"][
            "num_cells_by_type"
        ]
    return {
        kind: sum(n for cell, n in counts.items() if cell.startswith(names))
        for kind, names in KINDS.items()
    }


def main() -> None:
    for family, meaning in FAMILIES.items():
        print(f"\n{meaning} (synth_xilinx -family {family})")
        print(f"{'':18}" + "".join(f"{kind:>12}" for kind in KINDS))
        for name, scheme in forms().items():
            spec = scheme.build(PRECISE, 1, PRECISE.hidden_fmt.high)
            found = cells(spec, family)
            print(f"{name:18}" + "".join(f"{found[kind]:12}" for kind in KINDS), flush=True)


if __name__ == "__main__":
    sys.exit(run(main))
