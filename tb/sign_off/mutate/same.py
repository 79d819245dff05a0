"""Whether a mutant that no bench finds computes what the sound netlist does, by proof.

First within a clock: the same outputs and the same next state, from every state. Where that does
not hold, over clocks: from registers that are 0 the same outputs for ever, whatever comes in, data
compared where its flag says that it counts. That is done by ABC, which Yosys has inside: signals
that are the same are found by induction (scorr), the rest by property-directed reachability (pdr),
which also finds inputs that tell the two apart. Both are bounded by conflicts and clocks and not by
time, so that every machine finds the same.
"""

from __future__ import annotations

import json
from pathlib import Path

from hdl.synth.tools import run_tool
from tb.sign_off.mutate.flat import Flat, Netlist, flatten

SAME, OTHER, OPEN = "same", "other", "open"
PROVED = "SAT proof finished - no model found: SUCCESS!"
CONFLICTS, CLOCKS = 20_000, 60
ANSWERS = {"snl_UNSAT": SAME, "snl_SAT": OTHER, "snl_UNK": OPEN}
# Yosys gives ABC something to work on; the files it reads have nothing to do with that.
NOTHING = "module nothing(input a, b, output y); assign y = a & b; endmodule\n"


def proved(
    commands: list[str], entity: str, folder: Path, masks: dict[str, str]
) -> list[tuple[str, str]]:
    """Of each mutant whether it is the same, another, or neither is proved; and how."""
    if not commands:
        return []
    flat = flatten(commands, entity, folder)
    answers = dict.fromkeys(range(1, len(commands) + 1), (SAME, "nothing reads it"))
    asked = _within_a_clock(flat, sorted(flat.chosen), folder)
    answers |= dict.fromkeys(flat.chosen, (SAME, "in every state"))
    answers |= {
        n: (verdict, "over clocks") for n, verdict in _over_clocks(flat, asked, folder, masks)
    }
    return [answers[n] for n in sorted(answers)]


def _write(module: Netlist, path: Path) -> list[str]:
    """Write a module; the commands that read it."""
    path.write_text(json.dumps({"creator": "tactus", "modules": {"top": module}}), encoding="utf-8")
    return ["design -reset", f"read_json {path.name}", "hierarchy -top top"]


def _run(lines: list[str], folder: Path) -> str:
    (folder / "same.ys").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return run_tool("yosys", ["-s", "same.ys"], folder)


def _within_a_clock(flat: Flat, numbers: list[int], folder: Path) -> list[int]:
    """Those of which it cannot be shown."""
    lines = []
    for number in numbers:
        lines += _write(flat.within_a_clock(number), folder / f"within{number}.json")
        lines += ["opt", f"log mutant {number}", "sat -prove trigger 0 top"]
    said = _run(lines, folder).split("\nmutant ")[1:]
    return [n for n, text in zip(numbers, said, strict=True) if PROVED not in text]


def _over_clocks(
    flat: Flat, numbers: list[int], folder: Path, masks: dict[str, str]
) -> list[tuple[int, str]]:
    """What can be shown of each."""
    (folder / "nothing.v").write_text(NOTHING, encoding="utf-8")
    found = []
    for number in numbers:
        lines = _write(flat.over_clocks(number, masks), folder / "over.json")
        lines += ["opt", "memory_map", "setundef -init -zero", "opt -full", "techmap", "opt"]
        lines += ["dffunmap", "simplemap", "aigmap", "opt_clean", "write_aiger over.aig"]
        work = f"read_aiger,over.aig;scorr;write_aiger,left.aig;pdr,-C,{CONFLICTS},-F,{CLOCKS}"
        lines += ["design -reset", "read_verilog nothing.v", "simplemap"]
        lines += [f"abc -script +backup;{work};write_status,status.txt;restore;strash;map"]
        _run(lines, folder)
        found.append((number, _verdict(folder)))
    return found


def _verdict(folder: Path) -> str:
    """From what is left of the netlist, where that never rises, or from pdr."""
    lines = (folder / "left.aig").read_bytes().split(b"\n")
    latches = int(lines[0].split()[3])
    if lines[1 + latches] == b"0":
        return SAME
    return ANSWERS[(folder / "status.txt").read_text(encoding="utf-8").split()[0]]
