"""The mutants of an entity: which there are, and a netlist of each.

Only what stands in the entity itself is changed, the ports of its parts too: what stands in the
parts has a score of its own.
"""

import json
import random
import re
import tomllib
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

from tactus.synth.tools import run_tool

FILE = Path(__file__).parent / "explained.toml"


@cache
def _entries() -> dict[str, list[dict[str, Any]]]:
    """The entries by block. The file is read only once, because many mutants are looked up."""
    return tomllib.loads(FILE.read_text(encoding="utf-8"))


def explanations(block: str, case: str) -> dict[str, str]:
    """The reasons for a block in a case of its bench, by a pattern of what mutants change.

    An entry that names no cases holds in all of them.
    """
    entries = [one for one in _entries().get(block, []) if case in one.get("cases", [case])]
    return {entry["mutants"]: " ".join(entry["reason"].split()) for entry in entries}


def explain(block: str, case: str, what: str) -> str:
    """The reason that is written for a mutant; empty where there is none."""
    reasons = explanations(block, case).items()
    return next((reason for pattern, reason in reasons if re.fullmatch(pattern, what)), "")


# As many times what is asked for are listed, since some change nothing.
SPARE = 4
# What selects one of several mutants of a netlist.
SELECT = "mutsel"
# A choice of which a mutant takes two at once means the same to whoever reads it.
ONE_CHOICE = "pmuxtree"
# A read port without a clock has no enable and no reset, whatever stands on them: Yosys refuses a
# memory where that is no constant.
OF_A_CLOCK = ("RD_EN", "RD_ARST", "RD_SRST")


def make_mutants(
    files: list[str], entity: str, count: int, seed: int, folder: Path, parts: Sequence[str] = ()
) -> list[str]:
    """Yosys' commands for as many mutants of an entity and its parts as there are, up to ``count``.

    The files lie in ``folder``, where ``base.il`` becomes the sound netlist. ROMs stay the choices
    that they are in the source, so that each bit of their words is mutated like a bit of logic.
    """
    script = (
        f"read_verilog {' '.join(files)}; hierarchy -top {entity}; proc -norom; opt; wreduce; opt; "
        "memory_collect; write_rtlil base.il; write_json base.json; "
        f"mutate -list {SPARE * count} -seed {seed} -o mutants.txt {' '.join([entity, *parts])}"
    )
    run_tool("yosys", ["-q", "-p", script], folder)
    modules = json.loads((folder / "base.json").read_text(encoding="utf-8"))["modules"]
    listed = (folder / "mutants.txt").read_text(encoding="utf-8").splitlines()
    different = {_change(command, modules): command for command in reversed(listed)}
    different.pop(None, None)
    # Dictionaries keep their order, and so does a seeded choice.
    commands = list(reversed(different.values()))
    if len(commands) > count:
        commands = random.Random(seed).sample(commands, count)
    return commands


def given(command: str) -> dict[str, str]:
    words = command.split()
    return {key[1:]: value for key, value in zip(words[1::2], words[2::2], strict=True)}


def _change(command: str, modules: dict[str, Any]) -> tuple[str, ...] | None:
    """What a mutant changes, for a constant bit by its effect; None where that is nothing.

    A clock is no data: what would become of it is not for a bench to find, which makes it.
    """
    words = given(command)
    mode, module = words["mode"], modules[words["module"].removeprefix("\\")]
    clock = module["ports"].get("clk", {"bits": []})["bits"]
    cell = module["cells"][words["cell"].removeprefix("\\")]
    port = words["port"].removeprefix("\\")
    bits = cell["connections"][port]
    bit = bits[int(words["portbit"])]
    if bit in clock or (cell["type"] == "$mem_v2" and port in OF_A_CLOCK):
        return None
    if mode.startswith("cnot"):
        control = bits[int(words["ctrlbit"])]
        if control in ("0", "1"):
            if control != mode[-1]:
                return None
            mode = "inv"
        else:
            mode = f"{mode} {words['ctrlbit']}"
    if bit in ("0", "1"):
        if mode == f"const{bit}":
            return None
        if mode.startswith("const"):
            mode = "inv"
    return mode, words["module"], words["cell"], words["port"], words["portbit"]


def write_netlists(
    commands: list[str], entity: str, folder: Path, parts: Sequence[str] = ()
) -> list[Path]:
    """The Verilog of the entity itself with its parts, sound and with each mutant."""
    lines = ["read_rtlil base.il", "design -save base"]
    paths = [folder / f"mutant{number}.v" for number in range(len(commands) + 1)]
    for path, command in zip(paths, ["", *commands], strict=True):
        lines += ["design -load base", command, ONE_CHOICE, f"select {' '.join([entity, *parts])}"]
        lines += [f"write_verilog -noattr -selected {path.name}", "select -clear"]
    script = folder / "mutants.ys"
    script.write_text("\n".join(lines) + "\n", encoding="utf-8")
    run_tool("yosys", ["-q", "-s", script.name], folder)
    return paths
