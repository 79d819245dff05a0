"""The results of benches. Each that passed is kept under a key of all that it depends on.

The key holds the simulated files, the code of the bench and of everything that it imports, the
twin, the seed, the number of frames, and the versions of the tools. Failures are not kept. A result
is kept as soon as its bench ends, so an interrupted run goes on where it stopped.

A bench is given the whole design and the recorded frames of its scene. Most benches use less: their
own twin. So the key holds the value of the twin and the code of every class in it. Some benches
also ask for the recorded frames, for the blocks around their own or for shipped scenes. Only for
these the key also holds the code that reads scenes, the files of the scenes, and the twins of the
whole designs.

If entities of one block differ only in their constants, the demo simulates one of them by itself.
The others are simulated as parts of their networks, and by themselves in ``make sim``.
"""

import platform
import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from functools import cache
from importlib.metadata import version as version_of
from pathlib import Path
from typing import Any

from golden.common.block import Block, walk
from golden.networks.network import Network
from tactus.core import store
from tactus.core.closure import AREAS, closure, code, code_of, digest_of
from tactus.core.folders import BUILD
from tactus.core.progress import stage
from tactus.export.exporter import is_current
from tactus.scene import Scene
from tactus.synth.tools import digest
from tactus.verify.benches.runner import (
    Job,
    Outcome,
    jobs,
    plan,
    run_job,
    run_shown,
    scene_variable,
    shipped_for,
)
from tactus.verify.benches.tools import SIMULATORS, language, version

FACTS = ("compared", "seconds", "facts")
PACKAGES = ("cocotb", "cocotb-test", "cocotbext-axi", "numpy")
# This module gives every bench its twin, and the rest of the design to the benches that ask for it.
BENCH = "tb.common.bench"
ASKS = re.compile(r"\.(given|around)\b")
# The effect of cases is in the exported files, and properties are proved apart from benches.
ELSEWHERE = re.compile(r"tb\.(common\.(case_library|properties|watch)|\w+\.(prove_\w+|\w+_proof))$")
NAMES = ("CASES",)
SCENE = "tactus.scene"
# These list everything that a scene can choose. The blocks that they import matter only as twins.
REGISTRIES = ("golden.activation.schemes", "golden.networks.designs")
BLOCKS = tuple(f"golden.{area}." for area in AREAS)


def kept(job: Job) -> Outcome | None:
    """The kept result of a bench, if nothing that it depends on has changed.

    A result of all tests of a bench also counts as the result of one of them.
    """
    key = bench_key(job)
    for test in dict.fromkeys((job.test, "")):
        found = store.read(replace(key, parts=key.parts | {"test": test}), job.build)
        if found is not None:
            return Outcome(job, True, **{name: found[name] for name in FACTS})
    return None


def run_and_keep(job: Job) -> Outcome:
    """Run a bench, even if a result is kept, and keep the new result."""
    # What it depends on may change while it runs.
    key = bench_key(job)
    outcome = run_job(job)
    if outcome.passed:
        store.write(key, {name: getattr(outcome, name) for name in FACTS}, job.build)
    return outcome


def run_kept(job: Job) -> Outcome:
    return kept(job) or run_and_keep(job)


def bench_key(job: Job) -> store.Key:
    return store.key(
        "bench",
        entity=job.entity,
        test=job.test,
        seed=job.seed,
        frames=job.frames,
        simulated=digest(job.hdl_folder, job.files),
        bench=digest_of(bench_modules(job.area, job.block), without=NAMES),
        tools=_tools(job.simulator),
        **_twin_parts(job),
    )


def _twin_parts(job: Job) -> dict[str, store.Part]:
    """The parts of the key from ``golden``: the twin and, if the bench asks for it, the scene."""
    twin = job.twin
    found: dict[str, store.Part] = {"twin": repr(twin), "twins": code_of_twins(twin)}
    modules = bench_modules(job.area, job.block)
    if asks_for_scene(modules):
        scenes = [job.scene, *shipped_for(job)]
        designs = [scene.twin() for scene in scenes]
        found |= {"design": repr(designs), "designs": [code_of_twins(one) for one in designs]}
        found |= {"reading": _reading(), "scene": [file for one in scenes for file in one.files]}
    return found


@cache
def bench_modules(area: str, block: str) -> dict[str, Path]:
    """The bench and all modules that it imports, without cases and properties."""

    def follow(importer: str, imported: str) -> bool:
        return not ELSEWHERE.match(imported) and _follow(importer, imported)

    return closure([f"tb.{area}.tb_{block}"], follow)


def _follow(importer: str, imported: str) -> bool:
    """Whether an import is followed: blocks that a scene or a registry imports are not."""
    chooses = f"{importer}.".startswith(f"{SCENE}.") or importer in REGISTRIES
    return not (chooses and imported.startswith(BLOCKS))


def asks_for_scene(modules: dict[str, Path]) -> bool:
    """Whether a bench asks for more of its scene than its own twin."""
    return any(
        ASKS.search(code_of(path))
        for name, path in modules.items()
        if name.startswith("tb.") and name != BENCH
    )


def code_of_twins(twin: Block) -> str:
    """A digest of the code of all classes in a twin."""
    return _code(frozenset(module for block in walk(twin) for module in _classes(block)))


@cache
def _code(modules: frozenset[str]) -> str:
    return code(modules, _follow)


@cache
def _reading() -> str:
    """A digest of the code that reads scenes, without the code that builds twins."""
    return digest_of(closure([SCENE], _follow))


def _classes(value: object) -> Iterator[str]:
    """The modules of the classes of a value and of everything that it holds."""
    if is_dataclass(value):
        yield type(value).__module__
        inner = [getattr(value, field.name) for field in fields(value)]
    elif isinstance(value, dict):
        inner = [*value.keys(), *value.values()]
    else:
        inner = list(value) if isinstance(value, (tuple, list, set, frozenset)) else []
    for one in inner:
        if not isinstance(one, (int, float, str)):
            yield from _classes(one)


@cache
def _tools(simulator: str) -> list[str]:
    """The versions of the tools, asked only once because a scene may have hundreds of benches."""
    packages = [f"{name} {version_of(name)}" for name in PACKAGES]
    return [version(simulator), f"python {platform.python_version()}", *packages]


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
        texts.append(f"{text}; {more} plays all." if design.stream != "converter" else f"{text}.")
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
