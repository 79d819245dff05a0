"""Hardware leaves out what a scene does not need, and gives the same results."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from refused import call

from golden.numbers.precision import SIGNAL
from golden.trained.mlp import Mlp
from tactus.export.exporter import MANIFEST, export
from tactus.scene import Scene, load_scene, scene_names
from tactus.synth import lean
from tactus.synth.budget import read_budget, write_budget
from tactus.synth.timing import read_timing, write_timing
from tactus.verify.benches.written import write_scene
from tb.common.cases import FRONT_END, VISUALISATION, random_mlp


def exported(scene: Scene, folder: Path) -> tuple[set[str], str]:
    """The names of the blocks, and the text of all VHDL of a scene."""
    folder = folder / scene.name
    export(scene, "vhdl", folder)
    blocks = {entry["block"] for entry in json.loads((folder / MANIFEST).read_text())}
    return blocks, "\n".join(p.read_text() for p in sorted(folder.glob("*.vhd")))


def same_results(scene: Scene) -> None:
    whole, lean = scene.twin(lean=False), scene.twin()
    rng = np.random.default_rng(3)
    frames = rng.integers(SIGNAL.low, SIGNAL.high + 1, (3000, lean.inputs))
    assert (whole.process(frames) == lean.process(frames)).all()


def with_zeros() -> Mlp:
    """A network in which no output uses node 2, and some other weights are 0."""
    mlp = random_mlp((3, 4, 2), 1.0, 3)
    mlp.w1[0, 1] = mlp.w1[3, 0] = 0
    mlp.w2[:, 2] = 0
    mlp.w2[0, 1] = 0
    return mlp


@pytest.mark.parametrize("name", scene_names())
def test_results_are_those_of_the_whole(name: str) -> None:
    same_results(load_scene(name))


def test_segments_that_no_neuron_reaches(tmp_path: Path) -> None:
    path = write_scene(tmp_path, "few", "exact", [random_mlp((2, 2, 1), 0.2, 1)])
    scene = load_scene(str(path))
    same_results(scene)
    whole, lean = scene.twin(lean=False).activations[0], scene.twin().activations[0]
    saved = lean.parts_left_out()["comparators of segments no neuron reaches"]
    assert saved == len(whole.table.thresholds) - len(lean.table.thresholds) > 0
    _, text = exported(scene, tmp_path)
    assert len(re.findall(r"signed\(resize\(in_mag|in_mag > ", text)) < len(whole.table.thresholds)


@pytest.mark.parametrize("name", ["hybrid", "parallel"])
def test_hidden_nodes_and_multipliers_that_no_output_uses(tmp_path: Path, name: str) -> None:
    path = write_scene(tmp_path, "idle", "exact", [with_zeros()], design=name)
    scene = load_scene(str(path))
    same_results(scene)
    design = scene.twin()
    assert len(design.activations) == 3
    assert "1 hidden nodes whose weights to the outputs are 0" in design.left_out()
    _, text = exported(scene, tmp_path)
    node = r"u_input_node_\d+: entity" if name == "hybrid" else r"entity neuron_q\w+ is"
    assert len(re.findall(node, text)) == 3
    if name == "parallel":
        assert "3 multipliers of weights that are 0" in design.left_out()
        weights = [w for n in (*design.hidden_neurons, *design.output_neurons) for w in n.weights]
        assert weights.count(0) == 3
        assert len(re.findall(r"weigh\d+_product <= ", text)) == len(weights) - 3


def test_front_end_and_profile_that_the_scene_does_not_name(tmp_path: Path) -> None:
    mlp = random_mlp((2, 3, 4), 1.0, 1)
    found = {}
    for name, sections in (("bare", ""), ("full", VISUALISATION + FRONT_END)):
        path = write_scene(tmp_path, name, "exact", [mlp], sections=sections)
        scene = load_scene(str(path))
        found[name] = exported(scene, tmp_path)[0], scene.twin().process(np.full((1, 2), 99))
    bare, full = found["bare"][0], found["full"][0]
    assert full - bare == {
        *("instrument", "readout", "scan_sequencer", "load_profile", "ramp", "divider"),
        *("power_fold", "exp_memory", "exp_interpolator"),
    }
    assert (found["bare"][1] == found["full"][1]).all()


def is_stale(scene: Scene) -> bool:
    """Whether the record of a scene is of other hardware than ``make synth`` has recorded last."""
    found = lean.read_lean(scene.path)
    return (found.verilog, found.lean) != lean.synthesised(scene)


@pytest.mark.parametrize("name", scene_names())
def test_what_a_scene_saves_is_recorded_of_its_hardware(name: str) -> None:
    scene = load_scene(name)
    assert not is_stale(scene), f"run: make lean SCENE={name} RECORD=1"
    found = lean.read_lean(scene.path)
    assert found.lean["LUT"] <= found.whole["LUT"]


def test_a_record_of_other_hardware_is_stale(tmp_path: Path) -> None:
    shipped = load_scene("digit-reload")
    path = tmp_path / "digit-reload.toml"
    timing, verilog = read_timing(shipped.path)
    write_budget(path, read_budget(shipped.path))
    write_timing(path, timing, verilog)
    scene = replace(shipped, path=path)
    lean.record(scene)
    assert not is_stale(scene)
    write_timing(path, timing, "another")
    assert is_stale(scene)


@pytest.mark.all_only
@pytest.mark.usefixtures("yosys")
def test_the_savings_are_those_of_two_builds(tmp_path: Path, capsys) -> None:
    """Every run checks instead that the recorded savings are of the present hardware."""
    path = write_scene(tmp_path, "idle", "exact", [with_zeros()], activation="precise")
    call("lean", path)
    rows = [line.split() for line in capsys.readouterr().out.splitlines()[-3:]]
    whole, found, saved = ([int(n) for n in row[-5:]] for row in rows)
    assert [a - b for a, b in zip(whole, found, strict=True)] == saved
    # These are the cells of the node and its activation. Yosys itself removes its products of 0.
    assert saved[3] == 2
