"""Every bench, both simulators: the shipped scenes, and shapes that no shipped scene has."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import random_mlp, write_scene

from golden.block import walk
from golden.networks.mlp import Mlp
from golden.scene import Scene, load_scene, scene_names
from tb.common.runner import Outcome, plan, run_jobs
from tb.common.tools import SIMULATORS

# Shape, precision, spread of the weights of layer 1, activation: least shapes, more outputs than
# inputs (the spacing counter), one output, odd adder trees, Q_j of several hundred, and each
# activation with few and with all of its segments.
ODD = {
    "least": ((1, 1, 1), "precise", 1.0, "gradient"),
    "least-thesis": ((1, 2, 1), "thesis", 1.0, "gradient"),
    "wide": ((2, 3, 5), "precise", 1.0, "gradient"),
    "wide-thesis": ((3, 5, 4), "thesis", 1.0, "gradient"),
    "huge": ((4, 3, 2), "thesis", 100.0, "gradient"),
    "huge-precise": ((4, 3, 2), "precise", 100.0, "gradient"),
    "logic": ((2, 3, 2), "precise", 0.5, "precise"),
    "logic-huge": ((2, 2, 1), "precise", 100.0, "precise"),
    "block-ram": ((2, 3, 2), "precise", 0.5, "precise_block_ram"),
    "block-ram-huge": ((2, 2, 1), "precise", 100.0, "precise_block_ram"),
}


def odd_network(name: str) -> Mlp:
    """A random network; its last hidden node is without weights, where there is another."""
    shape, _, spread, _ = ODD[name]
    mlp = random_mlp(shape, spread, 7)
    if shape[1] > 1:
        mlp.w1[-1] = 0
        mlp.b1[-1] = 0
    return mlp


def odd_scene(name: str, folder: Path) -> Scene:
    shape, precision, _, activation = ODD[name]
    mlp = odd_network(name)
    return load_scene(str(write_scene(folder, name, shape, precision, mlp, activation=activation)))


ODD_BLOCKS = (
    "gradient",
    "precise",
    "hybrid",
    "input_controller",
    "output_controller",
    "output_integral",
)


@pytest.fixture(scope="module")
def outcomes(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[str, str], list[Outcome]]:
    """All outcomes by scene and simulator; the jobs share the cores."""
    folder = tmp_path_factory.mktemp("benches")
    jobs = []
    for name in scene_names():
        jobs += plan(load_scene(name), SIMULATORS, build=folder)
    for name in ODD:
        planned = plan(odd_scene(name, folder), SIMULATORS, build=folder)
        jobs += [job for job in planned if job.block in ODD_BLOCKS]
    found: dict[tuple[str, str], list[Outcome]] = {}
    for outcome in run_jobs(jobs, lambda _: None):
        found.setdefault((outcome.job.scene.name, outcome.job.simulator), []).append(outcome)
    return found


@pytest.mark.parametrize("simulator", SIMULATORS)
@pytest.mark.parametrize("scene", [*scene_names(), *ODD])
def test_hardware_equals_twin(outcomes, scene: str, simulator: str) -> None:
    results = outcomes[scene, simulator]
    failed = [f"{o.job.entity}: {o.complaint()}" for o in results if not o.passed]
    assert not failed, "\n".join(failed)
    present = {part.block for part in walk(results[0].job.scene.design())}
    expected = present if scene in scene_names() else present & set(ODD_BLOCKS)
    assert {o.job.block for o in results} == expected
    assert all(o.compared > 0 for o in results)


@pytest.mark.parametrize("scene", scene_names())
def test_both_simulators_compared_the_same(outcomes, scene: str) -> None:
    counts = [
        {o.job.entity: o.compared for o in outcomes[scene, simulator]} for simulator in SIMULATORS
    ]
    assert counts[0] == counts[1]


@pytest.mark.parametrize("scene", [*scene_names(), *ODD])
def test_clocks_are_the_same_in_both_simulators(outcomes, scene: str) -> None:
    timing = []
    for simulator in SIMULATORS:
        facts = next(o.facts for o in outcomes[scene, simulator] if o.job.block == "hybrid")
        timing.append((facts["clocks_per_frame"], facts["interval"]))
        inputs, _, outputs = next(iter(outcomes[scene, simulator])).job.scene.shape
        assert facts["interval"] == max(inputs, outputs)
    assert timing[0] == timing[1]


def test_the_shapes_differ_as_meant(tmp_path: Path) -> None:
    designs = {name: odd_scene(name, tmp_path).design() for name in ODD}
    assert designs["wide"].input_controller.spacing == 5
    assert designs["least"].input_controller.spacing == 0
    for form in ("logic", "block-ram"):
        assert (
            max(a.words for a in designs[form].activations)
            < designs[f"{form}-huge"].activations[0].words
        )
    assert max(int(a.variant[1:].split("c")[0]) for a in designs["huge"].activations) > 200
