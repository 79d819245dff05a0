"""Every bench, both simulators: the shipped scenes, and shapes that no shipped scene has."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import CASES

from golden.block import walk
from golden.scene import load_scene, scene_names
from tb.common.runner import Job, Outcome, plan, run_jobs
from tb.common.tools import SIMULATORS
from tb.report.measure.clocks import clocks_per_frame

pytestmark = pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")

# Every block of these scenes is simulated; of the others the network as a whole.
WHOLE = ("digit-single", "digit-single-thesis")

# The cases whose network is simulated.
TOPS = {"hybrid", "parallel", "cascade", "multiple", "readout", "instrument", "axis_network"}
NETWORKS = [name for name, case in CASES.items() if TOPS & set(case.blocks)]


def wanted(job: Job) -> bool:
    name = job.scene.name
    if name in CASES:
        return job.block in CASES[name].blocks
    return name in WHOLE or job.entity == job.scene.twin().entity


def chosen(jobs: list[Job]) -> list[Job]:
    """Of the wanted jobs of a scene, the first and the last entity of each block.

    The others differ in constants alone; ``make sim`` runs every one.
    """
    ends: dict[tuple[str, str], list[Job]] = {}
    for job in filter(wanted, jobs):
        ends.setdefault((job.simulator, job.block), []).append(job)
    return [job for same in ends.values() for job in same[:1] + same[1:][-1:]]


@pytest.fixture(scope="module")
def outcomes(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[str, str], list[Outcome]]:
    """All outcomes by scene and simulator; the jobs share the cores."""
    folder = tmp_path_factory.mktemp("benches")
    scenes = [load_scene(name) for name in scene_names()]
    scenes += [case.scene(folder, name) for name, case in CASES.items()]
    jobs = [j for scene in scenes for j in chosen(plan(scene, SIMULATORS, build=folder))]
    found: dict[tuple[str, str], list[Outcome]] = {}
    for outcome in run_jobs(jobs, lambda _: None):
        found.setdefault((outcome.job.scene.name, outcome.job.simulator), []).append(outcome)
    return found


@pytest.mark.parametrize("simulator", SIMULATORS)
@pytest.mark.parametrize("scene", [*scene_names(), *CASES])
def test_hardware_equals_twin(outcomes, scene: str, simulator: str) -> None:
    results = outcomes[scene, simulator]
    failed = [f"{o.job.entity}: {o.complaint()}" for o in results if not o.passed]
    assert not failed, "\n".join(failed)
    if scene in CASES:
        assert {o.job.block for o in results} == set(CASES[scene].blocks)
    elif scene in WHOLE:
        parts = walk(results[0].job.scene.twin())
        assert {o.job.block for o in results} == {part.block for part in parts}
    assert all(o.compared > 0 for o in results)


@pytest.mark.parametrize("scene", scene_names())
def test_both_simulators_compared_the_same(outcomes, scene: str) -> None:
    counts = [
        {o.job.entity: o.compared for o in outcomes[scene, simulator]} for simulator in SIMULATORS
    ]
    assert counts[0] == counts[1]


@pytest.mark.parametrize("scene", [*scene_names(), *NETWORKS])
def test_clocks_are_the_same_in_both_simulators(outcomes, scene: str) -> None:
    timing = []
    for simulator in SIMULATORS:
        results = outcomes[scene, simulator]
        design = results[0].job.scene.twin()
        facts = next(o.facts for o in results if o.job.entity == design.entity)
        timing.append((facts["clocks_per_frame"], facts["interval"]))
        assert facts["interval"] == design.interval
        assert facts["clocks_per_frame"] == clocks_per_frame(design)
    assert timing[0] == timing[1]


def test_the_cases_differ_as_meant(tmp_path: Path) -> None:
    designs = {name: case.scene(tmp_path, name).twin() for name, case in CASES.items()}
    assert designs["wide"].input_controller.spacing == 5
    assert designs["least"].input_controller.spacing == 0
    assert designs["wide-multiple"].input_controller.spacing == 3
    assert designs["pade-parallel"].interval == 3
    assert designs["parallel"].interval == 1
    assert designs["axis"].spacing == 5
    assert designs["axis-cascade"].slots == 2
    for name, interval in (("slow-cascade", 3), ("slower-cascade", 11)):
        assert designs[name].interval == interval
        assert designs[name].frame_store.outputs == 3
    assert designs["slow-axis-cascade"].spacing == 11
    assert designs["deep-cascade"].frame_store is None
    for form in ("logic", "block-ram"):
        few = max(a.words for a in designs[form].activations)
        assert few < designs[f"{form}-huge"].activations[0].words
    assert max(int(a.variant[1:].split("c")[0]) for a in designs["huge"].activations) > 200
    for name in CASES:
        if CASES[name].shapes == [(2, 1, 2)]:
            (activation,) = designs[name].activations
            assert bool(activation.left_out()) == name.endswith("short"), name
    assert designs["pade-exact"].input_controller.spacing == 3
    assert designs["profile"].load_profile.divider.gain_frac == 0
    assert designs["other-profile"].load_profile.divider.gain_frac == 15
    assert designs["other-profile"].load_profile.ramp.start < 0
