"""How many mutants of an entity are possible; those of a score are a sample of them."""

from collections.abc import Sequence
from pathlib import Path

from tactus.synth.tools import run_tool

# The digest of what that module does is part of every record, so this stands beside it.
from tactus.verify.sign_off.mutate.mutants import changes

# More than any entity has.
MOST = 100_000_000


def population(entities: Sequence[str], seed: int, folder: Path) -> int:
    """Count the possible mutants of some entities, in a folder where ``make_mutants`` has been.

    By which other bit each bit is made wrong is drawn, too, and where that is a constant or the bit
    itself the mutant counts as another or as none. So the number hangs a little on the seed.
    """
    of = " ".join(entities)
    script = f"read_rtlil base.il; mutate -list {MOST} -seed {seed} -o every.txt {of}"
    run_tool("yosys", ["-q", "-p", script], folder)
    return len({change for change, _ in changes("every.txt", folder)} - {None})
