"""How many mutants of an entity are possible; those of a score are a sample of them."""

from __future__ import annotations

import json
from pathlib import Path

from hdl.synth.tools import run_tool

# The digest of what that module does is part of every record, so this stands beside it.
from tb.sign_off.mutate.mutants import _change

# More than any entity has.
MOST = 100_000_000


def population(entity: str, folder: Path) -> int:
    """Count the possible mutants, in a folder where ``make_mutants`` has been."""
    script = f"read_rtlil base.il; mutate -list {MOST} -module {entity} -o every.txt"
    run_tool("yosys", ["-q", "-p", script], folder)
    module = json.loads((folder / "base.json").read_text(encoding="utf-8"))["modules"][entity]
    clock = module["ports"].get("clk", {"bits": []})["bits"]
    listed = (folder / "every.txt").read_text(encoding="utf-8").splitlines()
    changes = {_change(command, module["cells"], clock) for command in listed}
    return len(changes - {None})
