"""Whether hardware computes its network for every frame, as a program of its own.

    python3 prover.py network.json netlist.json

reads the network (`Network` says what its words mean) and the module that Yosys wrote after the
commands `READ`. It prints a line for each claim, and then what is found. It ends with 0 if all is
proved, with 1 if the hardware is wrong, and with 2 if neither is shown.
"""

import json
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tactus.verify.every_frame.counterexample import Evaluated, differing_frame, first_apart
from tactus.verify.every_frame.netlist import Netlist, NotReadableError, netlist
from tactus.verify.every_frame.sequences import DiffersError, RefusedError, Sequences, WrongError
from tactus.verify.every_frame.sums import UnsupportedError

PROVED, DIFFERS, UNKNOWN = range(3)
# What begins the line about each.
SAID = "proved for every frame: ", "DIFFERS: ", "not proved for every frame: "


@dataclass
class Verdict:
    """What is found: one of the three, why, and a frame whose output differs, if one is known."""

    code: int
    reason: str
    frame: list[int] | None = None
    output: int = 0

    def __str__(self) -> str:
        return SAID[self.code] + self.reason


def judge(
    given: dict[str, Any],
    hardware: Netlist,
    tell: Callable[[str], None],
    clock: Callable[[int], None] = lambda _: None,
) -> Verdict:
    """`tell` gets a line for each claim, and `clock` the number of clocks that were run."""
    tried = ""
    try:
        proof = Sequences(hardware, given, clock)
        for text, shown in proof.prove():
            tell(f"  {'proved' if shown else 'tried '}  {text}")
            tried = tried if shown else "; gaps are tried"
    except WrongError as reason:
        return Verdict(DIFFERS, str(reason))
    except DiffersError as found:
        return _differing(proof, found)
    except (RefusedError, UnsupportedError, NotReadableError) as reason:
        return Verdict(UNKNOWN, str(reason))
    frames = f"2^{given['bits'] * given['samples']}"
    return Verdict(PROVED, f"{frames}, {given['entity']}{given['around']}{tried}")


def _differing(proof: Sequences, found: DiffersError) -> Verdict:
    frame = differing_frame(proof.samples, found.got, found.expected)
    where = f"output {found.output}, {found.clock} clocks after the last sample"
    if frame is None:
        # Two forms of one value may look different; only a frame shows that they are.
        return Verdict(UNKNOWN, f"{where}: no frame is found at which it differs")
    words = [w for v in proof.samples for w in v.terms]  # type: ignore[union-attr]
    now = Evaluated(words, np.array([frame]))
    got, expected = (int(now.value(v)[0]) for v in (found.got, found.expected))
    said = f"{where}, frame {frame}: the hardware gives {got}, the network {expected}"
    said += f"; the first word that differs: {first_apart(proof, frame)} (each from 0)"
    return Verdict(DIFFERS, said, frame, found.output)


def main() -> int:
    given, read = (json.loads(Path(name).read_text(encoding="utf-8")) for name in sys.argv[1:3])
    try:
        hardware = netlist(read["modules"][given["entity"]])
    except NotReadableError as reason:
        verdict = Verdict(UNKNOWN, str(reason))
    else:
        verdict = judge(given, hardware, print)
    print(verdict)
    return verdict.code


if __name__ == "__main__":
    sys.exit(main())
