"""The results of the benches of a scene. Each is kept until something that it depends on changes.

The result of a bench is kept as soon as the bench ends (``tactus/verify/benches/kept_results.py``),
so an interrupted run goes on where it stopped. If entities of one block differ only in their
constants, one of them has a simulation of its own. The others are simulated as parts of their
networks, unless all are asked for.
"""

from collections import defaultdict
from dataclasses import replace
from typing import Any

from golden.common.block import walk
from golden.networks.network import Network
from tactus.core.folders import BUILD
from tactus.core.progress import stage
from tactus.export.exporter import is_current
from tactus.scene import Scene
from tactus.verify.benches.kept_results import bench_key, kept, run_and_keep
from tactus.verify.benches.runner import Job, Outcome, jobs, plan, run_shown, scene_variable
from tactus.verify.benches.tools import SIMULATORS, language


def chosen(planned: list[Job], full: bool = False) -> list[Job]:
    """For each simulator, every network and one entity of each other block; all with ``full``.

    The entity of a block is the first in ``planned``. A block around networks, such as a cascade or
    an instrument, plays only the recorded frames: its networks have complete simulations of their
    own, and a clock of the block takes as long as a clock of all of them together.
    """
    if full or not planned:
        return planned
    parts = walk(planned[0].scene.twin())
    networks = {part.entity: part for part in parts if isinstance(part, Network)}
    around = {
        entity
        for entity, network in networks.items()
        if sum(isinstance(part, Network) for part in walk(network)) > 1
    }
    first: dict[tuple[str, str], Job] = {}
    for job in planned:
        first.setdefault((job.simulator, job.block), job)
    ones = {job.folder for job in first.values()}
    return [
        replace(job, test="recorded") if job.entity in around else job
        for job in planned
        if job.entity in networks or job.folder in ones
    ]


def left_texts(results: dict[str, Any]) -> list[str]:
    """Sentences about the entities and the tests that are not chosen."""
    texts = []
    if results["left"]:
        texts.append(
            f"{results['left']} more benches are left to FULL=1: their entities differ from one "
            "above in constants alone, and are simulated within their networks."
        )
    if results["recorded"]:
        texts.append(
            f"To {' and '.join(results['recorded'])}, which are around networks, recorded frames "
            "are played alone; FULL=1 plays all of their benches."
        )
    if results["short"]:
        texts.append(results["short"])
    return texts


def short_text(scene: Scene, facts: dict[str, Any]) -> str:
    """A sentence if the bench of the whole scene plays fewer frames than there are recorded."""
    design, vectors = scene.twin(), scene.vectors()
    recorded = sum(map(len, vectors.recordings)) if design.past else len(vectors.codes)
    played = facts.get("frames", recorded)
    if played >= recorded:
        return ""
    text = (
        f"To {design.entity}, {played} of {recorded} recorded frames are played, because each "
        f"takes {design.interval} clocks"
    )
    if design.scanner is not None:
        # A bench of an instrument plays a few scans; its network has a bench of its own.
        return f"{text}."
    named = f"{scene_variable(scene)} BLOCK={design.block} FRAMES={recorded}"
    return f"{text}; make sim {named} plays all."


def stored_results(scene: Scene) -> dict[str, Any] | None:
    """The kept results of all entities, or else of the chosen ones.

    None if one of the chosen has not passed on what would be exported now.
    """
    if not all(is_current(scene, BUILD / scene.name / language(s)) for s in SIMULATORS):
        return None
    planned = [job for s in SIMULATORS for job in jobs(scene, s)]
    for full in (True, False):
        asked = chosen(planned, full)
        found = [outcome for job in asked if (outcome := kept(job))]
        if len(found) == len(asked):
            return _results(scene, found, len(found), asked, planned)
    return None


def simulate(scene: Scene, full: bool = False) -> dict[str, Any]:
    """Run the chosen benches, except those that have passed and have not changed since."""
    with stage(f"{scene.name}: exporting VHDL and Verilog, and compiling"):
        planned = plan(scene, SIMULATORS)
        asked = chosen(planned, full)
        keys = {job.folder: bench_key(job) for job in asked}
        stored = {job.folder: o for job in asked if (o := kept(job, keys[job.folder]))}
    missing = [job for job in asked if job.folder not in stored]
    ran = run_shown(
        f"{scene.name}: simulating",
        missing,
        lambda job: run_and_keep(job, keys[job.folder]),
        every=False,
    )
    found = stored | {outcome.job.folder: outcome for outcome in ran}
    return _results(scene, [found[job.folder] for job in asked], len(stored), asked, planned)


def _results(
    scene: Scene, outcomes: list[Outcome], stored: int, asked: list[Job], planned: list[Job]
) -> dict[str, Any]:
    top = scene.twin().entity
    facts = {o.job.simulator: o.facts for o in outcomes if o.job.entity == top}
    return {
        "benches": len(outcomes),
        "kept": stored,
        "left": len(planned) - len(asked),
        "recorded": sorted({job.entity for job in asked if job.test}),
        "failed": sum(not o.passed for o in outcomes),
        "compared": sum(o.compared for o in outcomes),
        "blocks": _by_block(outcomes),
        "facts": facts,
        "short": short_text(scene, next(iter(facts.values()), {})),
    }


def _by_block(outcomes: list[Outcome]) -> dict[str, Any]:
    """The numbers of entities and of compared values, for each block and simulator."""
    table: dict[str, Any] = defaultdict(lambda: {s: [0, 0] for s in SIMULATORS})
    for outcome in outcomes:
        cell = table[outcome.job.block][outcome.job.simulator]
        cell[0] += 1
        cell[1] += outcome.compared
    return dict(sorted(table.items()))
