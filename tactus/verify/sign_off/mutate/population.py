"""How many mutants of an entity are possible; those of a score are a sample of them."""

import json
from pathlib import Path

from tactus.synth.tools import run_tool

# The digest of what that module does is part of every record, so this stands beside it.
from tactus.verify.sign_off.mutate.mutants import _change

# More than any entity has.
MOST = 100_000_000


def population(entity: str, seed: int, folder: Path) -> int:
    """Count the possible mutants, in a folder where ``make_mutants`` has been with this seed.

    By which other bit each bit is made wrong is drawn, too, and where that is a constant or the bit
    itself the mutant counts as another or as none. So the number hangs a little on the seed.
    """
    script = f"read_rtlil base.il; mutate -list {MOST} -seed {seed} -module {entity} -o every.txt"
    run_tool("yosys", ["-q", "-p", script], folder)
    module = json.loads((folder / "base.json").read_text(encoding="utf-8"))["modules"][entity]
    clock = module["ports"].get("clk", {"bits": []})["bits"]
    listed = (folder / "every.txt").read_text(encoding="utf-8").splitlines()
    changes = {_change(command, module["cells"], clock) for command in listed}
    return len(changes - {None})
