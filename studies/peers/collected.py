"""Gathers the Verilog of a peer, with the changes that Yosys needs."""

import re
import shutil
from collections.abc import Sequence
from pathlib import Path

from golden.input_error import InputError

# Changes: a file, what is replaced in it, as a regular expression, and by what.
Edits = Sequence[tuple[str, str, str]]
ADDER = "shift_adder.v"
# With this attribute a sum is not merged with others into
# carry-save form, which takes more LUTs.
KEPT: Edits = [(ADDER, r"(wire \[[^]]*\] accum;)", r"(* keep *) \1")]


def collected(name: str, source: Path, folder: Path, edits: Edits) -> None:
    """Copy the Verilog and tables that alkaid wrote into a new folder, and change it."""
    folder.mkdir()
    for file in (*source.glob("*.v"), *source.glob("static/*.v"), *source.glob("memfiles/*.mem")):
        if not file.name.endswith("_wrapper.v"):
            shutil.copy(file, folder)
    for file_name, pattern, text in edits:
        path = folder / file_name
        changed, count = re.subn(pattern, text, path.read_text(encoding="utf-8"))
        if count != 1:
            raise InputError(f"{name}: {file_name}: got {count} times {pattern}, expected once")
        path.write_text(changed, encoding="utf-8")
