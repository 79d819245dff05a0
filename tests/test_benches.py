"""Every bench, both simulators: the shipped scenes, and shapes that no shipped scene has."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import random_mlp, write_scene

from golden.activation.schemes import SCHEMES
from golden.block import walk
from golden.networks.mlp import Mlp
from golden.precision import PRECISIONS
from golden.scene import Scene, load_scene, scene_names
from tb.common.runner import Outcome, plan, run_jobs
from tb.common.tools import SIMULATORS

pytestmark = pytest.mark.filterwarnings("ignore::golden.activation.pade.UnsettledWarning")

# Shape, precision, spread of the weights of layer 1: least shapes, more outputs than inputs (the
# spacing counter), one output, odd adder trees, and Q_j of several hundred.
ODD = {
    "least": ((1, 1, 1), "precise", 1.0),
    "least-thesis": ((1, 2, 1), "thesis", 1.0),
    "wide": ((2, 3, 5), "precise", 1.0),
    "wide-thesis": ((3, 5, 4), "thesis", 1.0),
    "huge": ((4, 3, 2), "thesis", 100.0),
    "huge-precise": ((4, 3, 2), "precise", 100.0),
}


# Activation, precision, seed: every activation but the one of the shipped scenes, in both
# precisions, with a neuron that reaches all segments (seed 8), and with one that does not (7).
SCHEME_SHAPE = (2, 1, 2)
ACTIVATIONS = {
    f"{name}-{precision}": (name, precision, 8)
    for name in SCHEMES
    if name != "gradient"
    for precision in PRECISIONS
} | {
    "lut-short": ("lut", "thesis", 7),
    "polynomial-short": ("polynomial", "precise", 7),
}
ACTIVATION_BLOCKS = {*SCHEMES, "comparator_bank", "hybrid", "input_controller"}


def odd_network(name: str) -> Mlp:
    """A random network; its last hidden node is without weights, where there is another."""
    shape, _, spread = ODD[name]
    mlp = random_mlp(shape, spread, 7)
    if shape[1] > 1:
        mlp.w1[-1] = 0
        mlp.b1[-1] = 0
    return mlp


def activation_scene(folder: Path, name: str) -> Scene:
    """A small network with one of the activations."""
    activation, precision, seed = ACTIVATIONS[name]
    mlp = random_mlp(SCHEME_SHAPE, 2.0, seed)
    return load_scene(
        str(write_scene(folder, name, SCHEME_SHAPE, precision, mlp, activation=activation))
    )


ODD_BLOCKS = ("gradient", "hybrid", "input_controller", "output_controller", "output_integral")


@pytest.fixture(scope="module")
def outcomes(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[str, str], list[Outcome]]:
    """All outcomes by scene and simulator; the jobs share the cores."""
    folder = tmp_path_factory.mktemp("benches")
    jobs = []
    for name in scene_names():
        jobs += plan(load_scene(name), SIMULATORS, build=folder)
    for name, (shape, precision, _) in ODD.items():
        mlp = odd_network(name)
        scene = load_scene(str(write_scene(folder, name, shape, precision, mlp)))
        jobs += [j for j in plan(scene, SIMULATORS, build=folder) if j.block in ODD_BLOCKS]
    for name in ACTIVATIONS:
        scene = activation_scene(folder, name)
        jobs += [j for j in plan(scene, SIMULATORS, build=folder) if j.block in ACTIVATION_BLOCKS]
    found: dict[tuple[str, str], list[Outcome]] = {}
    for outcome in run_jobs(jobs, lambda _: None):
        found.setdefault((outcome.job.scene.name, outcome.job.simulator), []).append(outcome)
    return found


@pytest.mark.parametrize("simulator", SIMULATORS)
@pytest.mark.parametrize("scene", [*scene_names(), *ODD, *ACTIVATIONS])
def test_hardware_equals_twin(outcomes, scene: str, simulator: str) -> None:
    results = outcomes[scene, simulator]
    failed = [f"{o.job.entity}: {o.complaint()}" for o in results if not o.passed]
    assert not failed, "\n".join(failed)
    present = {part.block for part in walk(results[0].job.scene.design())}
    chosen = set(ODD_BLOCKS) if scene in ODD else ACTIVATION_BLOCKS
    expected = present if scene in scene_names() else present & chosen
    assert {o.job.block for o in results} == expected
    assert all(o.compared > 0 for o in results)


@pytest.mark.parametrize("scene", scene_names())
def test_both_simulators_compared_the_same(outcomes, scene: str) -> None:
    counts = [
        {o.job.entity: o.compared for o in outcomes[scene, simulator]} for simulator in SIMULATORS
    ]
    assert counts[0] == counts[1]


@pytest.mark.parametrize("scene", [*scene_names(), *ODD, *ACTIVATIONS])
def test_clocks_are_the_same_in_both_simulators(outcomes, scene: str) -> None:
    timing = []
    for simulator in SIMULATORS:
        facts = next(o.facts for o in outcomes[scene, simulator] if o.job.block == "hybrid")
        timing.append((facts["clocks_per_frame"], facts["interval"]))
        design = next(iter(outcomes[scene, simulator])).job.scene.design()
        assert facts["interval"] == design.interval
        assert design.interval >= max(design.inputs, design.outputs)
    assert timing[0] == timing[1]


def test_the_shapes_differ_as_meant(tmp_path: Path) -> None:
    designs = {}
    for name, (shape, precision, _) in ODD.items():
        mlp = odd_network(name)
        designs[name] = load_scene(str(write_scene(tmp_path, name, shape, precision, mlp))).design()
    assert designs["wide"].input_controller.spacing == 5
    assert designs["least"].input_controller.spacing == 0
    assert max(int(a.variant[1:].split("c")[0]) for a in designs["huge"].activations) > 200
    for name in ACTIVATIONS:
        design = activation_scene(tmp_path, name).design()
        assert bool(design.activations[0].left_out()) == name.endswith("short"), name
    assert activation_scene(tmp_path, "pade-precise").design().input_controller.spacing == 3
