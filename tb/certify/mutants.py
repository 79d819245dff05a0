"""Mutants of an export's entities that its test bench or the proof of equality must find.

The test bench plays a few frames on each. Those on which it passes are compared with the sound
netlist, from every state. That is the function of the VHDL, as the step ``equality`` shows: so a
mutant is the same function too, or that step finds it.
"""

from __future__ import annotations

import os
import random
import shutil
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from hdl.export.exporter import compile_order
from hdl.export.handover.verilog_bench import BRIEF, PASSED
from hdl.synth.tools import ENDED
from tb.certify.recordings import SHORT
from tb.common.runner import Job
from tb.sign_off.mutate.mutants import make_mutants, write_netlists
from tb.sign_off.mutate.population import population
from tb.sign_off.mutate.same import OPEN, OTHER, SAME, proved_in_every_state
from tb.sign_off.mutate.words import describe

# The mutants of the first entity of a block, and of others, which differ from it in constants; and
# how many of each entity are delivered.
OF_FIRST, OF_OTHERS = 8, 3
DELIVERED = 1
# The processor time of one run; sound hardware takes a few seconds for thousands of frames.
SECONDS = 300


@dataclass(frozen=True)
class Mutants:
    """What became of the mutants of one entity.

    Attributes
    ----------
    entity : str
    population : int
        How many mutants are possible, of which these were drawn.
    played : int
        How many the test bench finds.
    equivalent : int
        How many of the others are proved to be the same function.
    differ : tuple of str
        Place and change of those others that are not, which the proof of equality finds.
    left : tuple of str
        Place and change of those of which neither is shown.
    """

    entity: str
    population: int
    played: int
    equivalent: int
    differ: tuple[str, ...]
    left: tuple[str, ...]

    @property
    def found(self) -> int:
        """How many the test bench or the proof of equality finds."""
        return self.played + len(self.differ)

    @property
    def count(self) -> int:
        return self.found + self.equivalent + len(self.left)


def write_mutants(job: Job, folder: Path, count: int, seed: int) -> Mutants:
    """Make up to ``count`` mutants of an entity, look for each, and deliver one that frames find.

    The folder holds ``design``, ``bench`` and ``equal``.
    """
    with tempfile.TemporaryDirectory() as name:
        work = Path(name)
        for file in job.files:
            shutil.copy(job.hdl_folder / file, work)
        commands = make_mutants(list(job.files), job.entity, count, seed, work)
        netlists = write_netlists(commands, job.entity, work)
        # The script plays all frames on the sound hardware.
        if not _passes(netlists[0], job.entity, folder, work):
            raise RuntimeError(f"{job.entity}: the netlist without a mutant fails")
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            seen = list(
                pool.map(lambda path: not _passes(path, job.entity, folder, work), netlists[1:])
            )
        quick = [n for n, found in enumerate(seen) if found]
        hidden = [n for n, found in enumerate(seen) if not found]
        verdicts = proved_in_every_state([commands[n] for n in hidden], job.entity, work)
        place = folder / "mutants"
        for n in sorted(random.Random(seed).sample(quick, min(DELIVERED, len(quick)))):
            where, what = describe(commands[n], work)
            place.mkdir(exist_ok=True)
            text = netlists[n + 1].read_text(encoding="utf-8")
            (place / f"{job.entity}.{n}.v").write_text(f"// {where}: {what}\n{text}")

        def places(verdict: str) -> tuple[str, ...]:
            those = [n for n, said in zip(hidden, verdicts, strict=True) if said == verdict]
            return tuple(": ".join(describe(commands[n], work)) for n in those)

        return Mutants(
            job.entity,
            population(job.entity, seed, work),
            len(quick),
            verdicts.count(SAME),
            places(OTHER),
            places(OPEN),
        )


def _passes(netlist: Path, entity: str, folder: Path, work: Path) -> bool:
    """Whether the test bench passes on a netlist of an entity among the sound others."""
    verilog = folder / "design" / "verilog"
    order = compile_order(verilog)
    files = [netlist if name == f"{entity}.v" else verilog / name for name in order]
    built = work / f"{netlist.stem}.vvp"
    (bench,) = (folder / "bench" / "verilog").glob("*_tb.v")
    command = ["iverilog", "-g2012", "-o", str(built), "-s", bench.stem, str(bench)]
    _run([*command, *map(str, files)], work)
    command = ["vvp", "-n", str(built), f"+{BRIEF}"]
    return _run(command, folder / "bench" / SHORT).split()[-1:] == [PASSED]


def _run(command: list[str], folder: Path) -> str:
    """What a tool printed; a mutant that does not end in time is one that differs."""
    limited = ["sh", "-c", 'ulimit -t "$0"; exec "$@"', str(SECONDS), *command]
    result = subprocess.run(limited, cwd=folder, capture_output=True, text=True, check=False)
    if result.returncode and result.returncode not in ENDED:
        raise RuntimeError(f"{' '.join(command)}: {result.stdout}{result.stderr}")
    return result.stdout
