"""Tests the default scenes: the instrument of the thesis, and the same task as built today."""

import pytest

from golden.common.block import walk
from tactus.scene import DEFAULT_SCENES, Scene, load_scene, scene_names, thesis_table

# The groups of blocks in chapters 4 and 5 of the thesis, by their names in every room.
OF_THE_THESIS = {
    "activation": "abs_unit comparator_bank g_memory i_memory grad_eqn sign_retriever gradient",
    "layers": "input_node input_integral output_integral input_controller output_controller",
    "networks": "hybrid cascade stream_multiplexer",
    "front end": "scan_sequencer",
    "visualisation": "power_fold ramp divider exp_memory load_profile",
}


@pytest.fixture(scope="module")
def thesis() -> Scene:
    return load_scene("thesis")


def test_the_default_scenes_are_shipped() -> None:
    assert DEFAULT_SCENES[0] == "thesis"
    assert set(DEFAULT_SCENES) <= set(scene_names())


def test_the_default_scenes_have_the_same_sensors_and_outputs() -> None:
    first, *others = map(load_scene, DEFAULT_SCENES)
    for other in others:
        assert (other.sensors, other.outputs) == (first.sensors, first.outputs)
        assert (other.data_paths, other.reference) == (first.data_paths, first.reference)


@pytest.mark.parametrize("group", OF_THE_THESIS)
def test_every_block_of_the_thesis_is_in_its_instrument(thesis: Scene, group: str) -> None:
    present = {part.block for part in walk(thesis.twin())}
    assert set(OF_THE_THESIS[group].split()) <= present


def test_its_scan_is_that_of_section_5_5(thesis: Scene) -> None:
    scan = thesis.twin().scan_sequencer
    assert (scan.inputs, scan.slots) == (4, 7)
    assert [f"{a:02b}" for a in scan.addresses[:7]] == ["00", "01", "10", "11", "00", "01", "10"]
    board = thesis_table("board")
    assert scan.counter_width == board["scan_counter_bits"]
    assert thesis.clock_mhz == board["clock_mhz"]
    assert 1000 * thesis.clock_mhz / scan.scan_clocks == board["scan_rate_khz"]


def test_its_networks_are_those_of_digit_thesis(thesis: Scene) -> None:
    networks = load_scene("digit-thesis")
    assert [p.resolve() for p in thesis.weights_paths] == [
        p.resolve() for p in networks.weights_paths
    ]
    assert thesis.precision.name == "thesis"
    assert thesis.twin().core == networks.twin()
