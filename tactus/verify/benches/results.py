"""The results of the benches of a scene. Each is kept until something that it depends on changes.

The result of a bench is kept as soon as the bench ends (``tactus/verify/benches/kept_results.py``),
so an interrupted run goes on where it stopped. If entities of one block differ only in their
constants, one of them has a simulation of its own. The others are simulated as parts of their
networks, and by themselves in ``make sim``.
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
from tactus.verify.benches.kept_results import kept, run_and_keep
from tactus.verify.benches.runner import Job, Outcome, jobs, plan, run_shown, scene_variable
from tactus.verify.benches.tools import SIMULATORS, language


def chosen(planned: list[Job]) -> list[Job]:
    """For each simulator, every network and one entity of each other block.

    The entity of a block is the first in ``planned``. A block around networks, such as a cascade or
    an instrument, plays only the recorded frames: its networks have complete simulations of their
    own, and a clock of the block takes as long as a clock of all of them together.
    """
    if not planned:
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


def _left_out(
    scene: Scene, asked: list[Job], planned: list[Job], facts: dict[str, Any]
) -> list[str]:
    """Sentences about the entities, the tests and the frames that are not simulated."""
    texts, every = [], f"make sim {scene_variable(scene)}"
    if len(asked) < len(planned):
        texts.append(
            f"{len(planned) - len(asked)} more benches are left to {every}: their entities differ "
            "from one above in constants alone, and are simulated within their networks."
        )
    if around := sorted({job.entity for job in asked if job.test}):
        texts.append(
            f"To {' and '.join(around)}, which are around networks, recorded frames are played "
            f"alone; {every} plays all of their benches."
        )
    design, vectors = scene.twin(), scene.vectors()
    recorded = sum(map(len, vectors.recordings)) if design.past else len(vectors.codes)
    played = facts.get("frames", recorded)
    if played < recorded:
        text = (
            f"To {design.entity}, {played} of {recorded} recorded frames are played, because each "
            f"takes {design.interval} clocks"
        )
        # A bench of an instrument plays a few scans; its network has a bench of its own.
        more = f"{every} BLOCK={design.block} FRAMES={recorded}"
        texts.append(f"{text}; {more} plays all." if design.scanner is None else f"{text}.")
    return texts


def stored_results(scene: Scene) -> dict[str, Any] | None:
    """The kept results of all entities, or else of the chosen ones.

    None if one of the chosen has not passed on what would be exported now.
    """
    if not all(is_current(scene, BUILD / scene.name / language(s)) for s in SIMULATORS):
        return None
    planned = [job for s in SIMULATORS for job in jobs(scene, s)]
    for asked in (planned, chosen(planned)):
        found = [outcome for job in asked if (outcome := kept(job))]
        if len(found) == len(asked):
            return _results(scene, found, len(found), asked, planned)
    return None


def simulate(scene: Scene) -> dict[str, Any]:
    """Run the chosen benches, except those that have passed and have not changed since."""
    with stage(f"{scene.name}: exporting VHDL and Verilog, and compiling"):
        planned = plan(scene, SIMULATORS)
        asked = chosen(planned)
        found = {job.folder: outcome for job in asked if (outcome := kept(job))}
    stored = len(found)
    missing = [job for job in asked if job.folder not in found]
    ran = run_shown(f"{scene.name}: simulating", missing, run_and_keep, every=False)
    found |= {outcome.job.folder: outcome for outcome in ran}
    return _results(scene, [found[job.folder] for job in asked], stored, asked, planned)


def _results(
    scene: Scene, outcomes: list[Outcome], stored: int, asked: list[Job], planned: list[Job]
) -> dict[str, Any]:
    top = scene.twin().entity
    facts = {o.job.simulator: o.facts for o in outcomes if o.job.entity == top}
    # The numbers of entities and of compared values, for each block and simulator.
    blocks: dict[str, Any] = defaultdict(lambda: {s: [0, 0] for s in SIMULATORS})
    for outcome in outcomes:
        cell = blocks[outcome.job.block][outcome.job.simulator]
        cell[0] += 1
        cell[1] += outcome.compared
    return {
        "benches": len(outcomes),
        "kept": stored,
        "failed": sum(not o.passed for o in outcomes),
        "compared": sum(o.compared for o in outcomes),
        "blocks": dict(sorted(blocks.items())),
        "facts": facts,
        "left_out": _left_out(scene, asked, planned, next(iter(facts.values()), {})),
    }
