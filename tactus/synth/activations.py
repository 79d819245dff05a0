"""``python -m tactus.synth.activations``: show what each activation costs, with every segment."""

import tempfile
from pathlib import Path

from golden.activation.schemes import forms
from golden.common.block import Block
from golden.numbers.precision import EXACT
from tactus.core.cli import run_repeatable, stop_if_dry_run
from tactus.export.hierarchy import convert_hierarchy, elaborate
from tactus.synth.cells import FAMILIES, synthesise
from tactus.synth.netlist import KINDS


def cells(spec: Block, family: str) -> dict[str, int]:
    """The cells of a block and its parts after ``synth_xilinx``."""
    with tempfile.TemporaryDirectory() as name:
        convert_hierarchy(elaborate(spec), Path(name), "verilog")
        return synthesise(Path(name), spec.entity, family)[spec.entity]


def main() -> None:
    stop_if_dry_run("synthesise every activation")
    for family, meaning in FAMILIES.items():
        print(f"\n{meaning} (synth_xilinx -family {family})")
        print(f"{'':18}" + "".join(f"{kind:>12}" for kind in KINDS))
        for name, scheme in forms().items():
            spec = scheme.build(EXACT, 1, EXACT.hidden_fmt.high)
            found = cells(spec, family)
            print(f"{name:18}" + "".join(f"{found[kind]:12}" for kind in KINDS), flush=True)


if __name__ == "__main__":
    run_repeatable("tactus.synth.activations", main)
