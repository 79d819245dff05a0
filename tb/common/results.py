"""What the benches of a scene found, kept until anything that they depend on changes."""

from __future__ import annotations

import json
from collections import defaultdict
from pathlib import Path
from typing import Any

from golden.files import replace_file
from golden.fingerprint import fingerprint, sources
from golden.progress import Progress
from golden.scene import Scene
from tb.common.runner import BUILD, Outcome, plan, run_jobs
from tb.common.tools import SIMULATORS, language, version
from tb.sim import tell


def _store(scene: Scene) -> Path:
    return BUILD / scene.name / "sim" / "results.json"


def state(scene: Scene) -> str:
    """A digest of everything that the benches of an exported scene depend on."""
    inputs = [*sources("golden", "hdl", "tb"), *scene.files]
    inputs += [BUILD / scene.name / language(s) for s in SIMULATORS]
    return fingerprint(inputs, *(version(s) for s in SIMULATORS))


def stored_results(scene: Scene) -> dict[str, Any] | None:
    """What the benches found, if nothing has changed since; None otherwise."""
    if not _store(scene).is_file():
        return None
    results = json.loads(_store(scene).read_text(encoding="utf-8"))
    return results if results["state"] == state(scene) else None


def simulate(scene: Scene) -> dict[str, Any]:
    """Run all benches of the scene, or take over the results of unchanged ones."""
    jobs = plan(scene, SIMULATORS)
    results = stored_results(scene)
    if results is not None:
        return results | {"fresh": False}
    top = scene.twin().entity
    with Progress(f"{scene.name}: simulating", len(jobs), "benches") as progress:

        def listen(outcome: Outcome) -> None:
            """Only failures get lines of their own."""
            if not outcome.passed:
                tell(outcome, progress.say)
            progress.step(outcome.job.entity)

        outcomes = run_jobs(jobs, listen)
    results = {
        "state": state(scene),
        "benches": len(outcomes),
        "failed": sum(not o.passed for o in outcomes),
        "compared": sum(o.compared for o in outcomes),
        "blocks": _by_block(outcomes),
        "facts": {o.job.simulator: o.facts for o in outcomes if o.job.entity == top},
    }
    if not results["failed"]:
        with replace_file(_store(scene)) as temporary:
            temporary.write_text(json.dumps(results, indent=1), encoding="utf-8")
    return results | {"fresh": True}


def _by_block(outcomes: list[Outcome]) -> dict[str, Any]:
    """Entities and values compared, per block and simulator."""
    table: dict[str, Any] = defaultdict(lambda: {s: [0, 0] for s in SIMULATORS})
    for outcome in outcomes:
        cell = table[outcome.job.block][outcome.job.simulator]
        cell[0] += 1
        cell[1] += outcome.compared
    return dict(sorted(table.items()))
