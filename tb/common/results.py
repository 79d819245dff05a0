"""What the benches of a scene found, each kept until anything that it depends on changes.

A bench's result is kept when it ends, so that what was interrupted goes on where it stopped.
Of entities of one block that differ in constants alone, one is simulated by itself and the others
within the networks that they are parts of, unless all are asked for.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from pathlib import Path
from typing import Any

from golden.block import walk
from golden.files import read_kept, write_kept
from golden.fingerprint import fingerprint, sources
from golden.networks.network import Network
from golden.progress import Progress, stage
from golden.scene import Scene
from hdl.export.exporter import MANIFEST
from tb.common.runner import BUILD, Job, Outcome, jobs, plan, run_job, run_jobs
from tb.common.tools import SIMULATORS, language, version
from tb.sim import tell


def state(scene: Scene) -> str:
    """A digest of everything that the benches of an exported scene depend on."""
    inputs = [*sources("golden", "hdl", "tb"), *scene.files]
    inputs += [BUILD / scene.name / language(s) for s in SIMULATORS]
    return fingerprint(inputs, *(version(s) for s in SIMULATORS))


def chosen(planned: list[Job], full: bool = False) -> list[Job]:
    """Under each simulator every network and one entity of each other block; all with ``full``.

    That one is the first of ``planned``. A network that holds others and is inside the scene's top,
    as a cascade in an instrument, plays the recorded frames alone: its parts and what is around it
    are simulated whole, and each of its clocks takes as long as theirs together.
    """
    if full or not planned:
        return planned
    top = planned[0].scene.twin()
    networks = {part.entity: part for part in walk(top) if isinstance(part, Network)}
    between = {
        entity
        for entity, network in networks.items()
        if entity != top.entity and sum(isinstance(part, Network) for part in walk(network)) > 1
    }
    first: dict[tuple[str, str], Job] = {}
    for job in planned:
        first.setdefault((job.simulator, job.block), job)
    ones = {job.folder for job in first.values()}
    return [
        replace(job, test="recorded") if job.entity in between else job
        for job in planned
        if job.entity in networks or job.folder in ones
    ]


def left_texts(results: dict[str, Any]) -> list[str]:
    """What became of the entities, and of the tests, that are not chosen."""
    texts = []
    if results["left"]:
        texts.append(
            f"{results['left']} more benches are left to FULL=1: their entities differ from one "
            "above in constants alone, and are simulated within their networks."
        )
    if results["recorded"]:
        texts.append(
            f"Of {' and '.join(results['recorded'])}, which stand between networks and the top, "
            "recorded frames are played alone; FULL=1 plays all of their benches."
        )
    return texts


def stored_results(scene: Scene) -> dict[str, Any] | None:
    """What the benches found, of all entities or else of those that are chosen.

    None where not all of these have passed, or something has changed since.
    """
    if not all((BUILD / scene.name / language(s) / MANIFEST).is_file() for s in SIMULATORS):
        return None
    now = state(scene)
    planned = [job for s in SIMULATORS for job in jobs(scene, s)]
    for full in (True, False):
        asked = chosen(planned, full)
        found = [outcome for job in asked if (outcome := _kept(job, now))]
        if len(found) == len(asked):
            return _results(scene, found, len(found), asked, planned)
    return None


def simulate(scene: Scene, full: bool = False) -> dict[str, Any]:
    """Run the benches that are chosen, but for those that have passed and are unchanged since."""
    with stage(f"{scene.name}: exporting VHDL and Verilog, and compiling"):
        planned = plan(scene, SIMULATORS)
        asked = chosen(planned, full)
        now = state(scene)
    kept = {job.folder: outcome for job in asked if (outcome := _kept(job, now))}
    missing = [job for job in asked if job.folder not in kept]
    with Progress(f"{scene.name}: simulating", len(missing), "benches") as progress:

        def listen(outcome: Outcome) -> None:
            """Only failures get lines of their own."""
            if not outcome.passed:
                tell(outcome, progress.say)
            progress.step()

        def work(job: Job) -> Outcome:
            with progress.running(f"{job.entity} on {job.runs_on}"):
                return _run_and_keep(now, job)

        ran = run_jobs(missing, listen, work=work)
    found = kept | {outcome.job.folder: outcome for outcome in ran}
    return _results(scene, [found[job.folder] for job in asked], len(kept), asked, planned)


def _results(
    scene: Scene, outcomes: list[Outcome], kept: int, asked: list[Job], planned: list[Job]
) -> dict[str, Any]:
    top = scene.twin().entity
    return {
        "benches": len(outcomes),
        "kept": kept,
        "left": len(planned) - len(asked),
        "recorded": sorted({job.entity for job in asked if job.test}),
        "failed": sum(not o.passed for o in outcomes),
        "compared": sum(o.compared for o in outcomes),
        "blocks": _by_block(outcomes),
        "facts": {o.job.simulator: o.facts for o in outcomes if o.job.entity == top},
    }


def _record(job: Job) -> Path:
    """In the bench's folder, so that another run of the bench takes it away."""
    return job.folder / "outcome.json"


def _run_and_keep(now: str, job: Job) -> Outcome:
    outcome = run_job(job)
    if outcome.passed:
        found = {
            "state": now,
            "test": job.test,
            "compared": outcome.compared,
            "seconds": outcome.seconds,
            "facts": outcome.facts,
        }
        write_kept(_record(job), found)
    return outcome


def _kept(job: Job, now: str) -> Outcome | None:
    """What the bench found, if it passed in this state with all that is asked of it."""
    found = read_kept(_record(job))
    if not isinstance(found, dict) or found.get("state") != now:
        return None
    if found["test"] not in ("", job.test):
        return None
    return Outcome(job, True, found["compared"], found["seconds"], found["facts"])


def _by_block(outcomes: list[Outcome]) -> dict[str, Any]:
    """Entities and values compared, per block and simulator."""
    table: dict[str, Any] = defaultdict(lambda: {s: [0, 0] for s in SIMULATORS})
    for outcome in outcomes:
        cell = table[outcome.job.block][outcome.job.simulator]
        cell[0] += 1
        cell[1] += outcome.compared
    return dict(sorted(table.items()))
