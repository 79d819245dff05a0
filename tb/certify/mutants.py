"""Mutants of an export's entities that its test bench must find."""

from __future__ import annotations

import os
import random
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from hdl.export.exporter import compile_order
from hdl.export.handover.verilog_bench import PASSED
from hdl.synth.tools import ENDED
from tb.certify.recordings import SHORT
from tb.common.runner import Job
from tb.sign_off.equal_proof import DIFFERENT, compare
from tb.sign_off.mutate.mutants import make_mutants, write_netlists
from tb.sign_off.mutate.same import SAME, proved
from tb.sign_off.mutate.words import describe

# The mutants of each entity, and those of them that are delivered.
COUNT = 8
DELIVERED = 1
# The processor time of one run; sound hardware takes a few seconds for thousands of frames.
SECONDS = 300


@dataclass(frozen=True)
class Mutants:
    """What became of the mutants of one entity.

    Attributes
    ----------
    entity : str
    played : int
        How many the test bench finds.
    equivalent : int
        How many of the others are proved to change nothing.
    differ : tuple of str
        Place and change of those others that are no longer equal to the VHDL, which the proof of
        equality finds.
    left : tuple of str
        Place and change of those that nothing finds.
    """

    entity: str
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


def write_mutants(job: Job, folder: Path, seed: int) -> Mutants:
    """Make mutants of an entity, play the delivered test bench on each, and deliver some.

    The folder holds ``design`` and ``bench``.
    """
    with tempfile.TemporaryDirectory() as name:
        work = Path(name)
        for file in job.files:
            shutil.copy(job.hdl_folder / file, work)
        commands = make_mutants(list(job.files), job.entity, COUNT, seed, work)
        netlists = write_netlists(commands, job.entity, work)
        short = folder / "bench" / SHORT
        whole = [short, *sorted((folder / "bench" / "verilog").glob("*/"))]
        # The script plays everything on the sound hardware.
        sound = _found_in(netlists[0], job.entity, folder, work, [short])
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            seen = list(
                pool.map(
                    lambda path: _found_in(path, job.entity, folder, work, whole), netlists[1:]
                )
            )
        if sound:
            raise RuntimeError(f"{job.entity}: the netlist without a mutant differs in {sound}")
        quick = [n for n, where in enumerate(seen) if where == SHORT]
        left = [n for n, where in enumerate(seen) if not where]
        verdicts = proved([commands[n] for n in left], job.entity, work, {})
        same = [n for n, (verdict, _) in zip(left, verdicts, strict=True) if verdict == SAME]
        place = folder / "mutants"
        place.mkdir(exist_ok=True)
        for n in sorted(random.Random(seed).sample(quick, min(DELIVERED, len(quick)))):
            where, what = describe(commands[n], work)
            text = netlists[n + 1].read_text(encoding="utf-8")
            (place / f"{job.entity}.{n}.v").write_text(f"// {where}: {what}\n{text}")
        others: dict[bool, list[str]] = {True: [], False: []}
        for n in left:
            if n not in same:
                differs = _differs(netlists[n + 1], job, folder)
                others[differs].append(": ".join(describe(commands[n], work)))
        return Mutants(
            job.entity, len(commands) - len(left), len(same), *map(tuple, others.values())
        )


def _differs(netlist: Path, job: Job, folder: Path) -> bool:
    """Whether a mutant is another function than the delivered VHDL."""
    name = f"{job.entity}.v"
    vhdl = (folder / "equal" / name).read_text(encoding="utf-8")
    parts = [job.hdl_folder / file for file in job.files if file != name]
    text = netlist.read_text(encoding="utf-8")
    return bool(compare(job.entity, text, vhdl, parts)["result"] == DIFFERENT)


def _found_in(
    netlist: Path, entity: str, folder: Path, work: Path, recordings: Sequence[Path]
) -> str:
    """The name of the first recording that differs on a netlist; empty for none."""
    verilog = folder / "design" / "verilog"
    order = compile_order(verilog)
    files = [netlist if name == f"{entity}.v" else verilog / name for name in order]
    built = work / f"{netlist.stem}.vvp"
    (bench,) = (folder / "bench" / "verilog").glob("*_tb.v")
    command = ["iverilog", "-g2012", "-o", str(built), "-s", bench.stem, str(bench)]
    _run([*command, *map(str, files)], work)
    for recording in recordings:
        if _run(["vvp", "-n", str(built)], recording).split()[-1:] != [PASSED]:
            return recording.name
    return ""


def _run(command: list[str], folder: Path) -> str:
    """What a tool printed; a mutant that does not end in time is one that differs."""
    limited = ["sh", "-c", 'ulimit -t "$0"; exec "$@"', str(SECONDS), *command]
    result = subprocess.run(limited, cwd=folder, capture_output=True, text=True, check=False)
    if result.returncode and result.returncode not in ENDED:
        raise RuntimeError(f"{' '.join(command)}: {result.stdout}{result.stderr}")
    return result.stdout
