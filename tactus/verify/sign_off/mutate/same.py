"""Whether a mutant that no bench finds computes what the sound netlist does, by proof.

First within a clock: the same outputs and the same next state, from every state. Where that does
not hold, over clocks, from registers that are 0 and a clock of reset on: the same outputs and the
same next state still, from every state that the sound netlist reaches; or else the same outputs for
ever. Data is compared where its flag says that it counts. That is done by ABC, which Yosys has
inside: signals that are the same are found by induction (scorr), the rest by property-directed
reachability (pdr), which also finds inputs that tell the two apart. All are bounded by conflicts
and clocks, but over clocks by processor time as well, which other work on the machine does not use
up: a slower processor may leave open what this one proves, and score less. What is too large for
that is left open at once.
"""

import json
import os
from collections.abc import Collection
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from tactus.synth.tools import run_tool
from tactus.verify.sign_off.mutate.flat import Flat, Netlist, flatten, stored_bits

SAME, OTHER, OPEN = "same", "other", "open"
CONFLICTS, CLOCKS = 20_000, 400
SECONDS = (10, 600)
# Of more bits in registers and memories nothing is shown over clocks in so little time.
STORED = 2000
ANSWERS = {"snl_UNSAT": SAME, "snl_SAT": OTHER, "snl_UNK": OPEN}
# What gives an AIG's registers their first values, and its memories registers.
STEPS = ["setundef -init -zero", "opt", "memory_map", "setundef -init -zero", "opt -full"]
STEPS += ["techmap", "opt", "dffunmap", "simplemap"]
# Yosys gives ABC something to work on; the files it reads have nothing to do with that.
NOTHING = "module nothing(input a, b, output y); assign y = a & b; endmodule\n"


def proved(
    commands: list[str],
    entity: str,
    folder: Path,
    masks: dict[str, str],
    explained: Collection[int] = (),
) -> list[str]:
    """Of each mutant whether it is the same, another, or neither is proved.

    Those that are ``explained``, by number from 1, are looked at within a clock alone.
    """
    if not commands:
        return []
    flat = flatten(commands, entity, folder)
    # What nothing reads is the same, and so is what differs from no state within a clock.
    answers = dict.fromkeys(range(1, len(commands) + 1), SAME)
    asked = [n for n, verdict in _within_a_clock(flat, folder).items() if verdict != SAME]

    def work(n: int) -> str:
        return OPEN if n in explained else _over_clocks(flat, n, masks, folder)

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        answers |= zip(asked, pool.map(work, asked), strict=True)
    return list(answers.values())


def _within_a_clock(flat: Flat, folder: Path) -> dict[int, str]:
    """What is shown of each mutant that something reads, by number from 1."""
    numbers = sorted(flat.chosen)
    prepared = [
        _write(flat.within_a_clock(n), folder, f"within{n}", ["opt", "techmap", "opt"])
        for n in numbers
    ]
    work = f"strash;fraig,-C,1000;write_aiger,{{0}}.left.aig;dsat,-C,{CONFLICTS}"
    verdicts = ask(prepared, [f"within{n}" for n in numbers], work, folder)
    return dict(zip(numbers, verdicts, strict=True))


def _over_clocks(flat: Flat, number: int, masks: dict[str, str], folder: Path) -> str:
    """What can be shown of one: that no state ever differs or, which alone is final, no output."""
    products = {"states": flat.from_reset, "outputs": flat.over_clocks}
    prepared: dict[str, list[str]] = {}
    for seconds in SECONDS:
        for kind, product in list(products.items()):
            name = f"{kind}{number}"
            if kind not in prepared:
                module = product(number, masks)
                if stored_bits(module) > STORED:
                    del products[kind]
                    continue
                prepared[kind] = _write(module, folder, name, STEPS)
            work = f"scorr,-F,2;write_aiger,{{0}}.left.aig;pdr,-C,{CONFLICTS},-F,{CLOCKS}"
            verdict = ask([prepared[kind]], [name], work, folder, seconds)[0]
            if verdict == SAME or (verdict == OTHER and kind == "outputs"):
                return verdict
            if verdict == OTHER:
                del products[kind]
    return OPEN


def _write(module: Netlist, folder: Path, name: str, steps: list[str]) -> list[str]:
    """Write a module; the commands that make an AIG of it."""
    text = json.dumps({"creator": "tactus", "modules": {"top": module}})
    (folder / f"{name}.json").write_text(text, encoding="utf-8")
    read = ["design -reset", f"read_json {name}.json", "hierarchy -top top"]
    return [*read, *steps, "setundef -zero", "aigmap", "opt_clean", f"write_aiger {name}.aig"]


def ask(
    prepared: list[list[str]], names: list[str], work: str, folder: Path, seconds: int | None = None
) -> list[str]:
    """Whether ``trigger`` can rise in each AIG; ``work`` is what ABC does with it.

    All of it ends after so many ``seconds`` of processor time, if that is given.
    """
    if not names:
        return []
    asked = [f"read_aiger,{n}.aig;{work.format(n)};write_status,{n}.txt" for n in names]
    nothing, script = (folder / f"{names[0]}.{kind}" for kind in ("v", "ys"))
    nothing.write_text(NOTHING, encoding="utf-8")
    lines = [line for part in prepared for line in part]
    lines += ["design -reset", f"read_verilog {nothing.name}", "simplemap"]
    lines += [f"abc -script +backup;{';'.join(asked)};restore;strash;map"]
    script.write_text("\n".join(lines) + "\n", encoding="utf-8")
    run_tool("yosys", ["-q", "-s", script.name], folder, seconds=seconds)
    return [_verdict(folder, name) for name in names]


def _verdict(folder: Path, name: str) -> str:
    """From what is left of the netlist, where that never rises, or from the last that was done.

    That says nothing where its time was over.
    """
    status = folder / f"{name}.txt"
    said = status.read_text(encoding="utf-8").split() if status.exists() else []
    if not said:
        return OPEN
    lines = (folder / f"{name}.left.aig").read_bytes().split(b"\n")
    latches = int(lines[0].split()[3])
    return SAME if lines[1 + latches] == b"0" else ANSWERS[said[0]]
