"""Tests what is read of a scene, and the default scenes."""

import tomllib
from pathlib import Path

import pytest

from golden.common.block import walk
from golden.input_error import InputError
from tactus.network_files.network_file import provenance_path
from tactus.report.page.summary import built
from tactus.scene import (
    DEFAULT_SCENES,
    Scene,
    comparison_names,
    load_scene,
    scene_names,
    thesis_table,
)
from tactus.scene.reading import class_names, in_todays_words


def edited(scene: Scene, old: str, new: str) -> str:
    """Replace a text in the file of the scene, and return its path."""
    text = scene.path.read_text()
    assert old in text
    scene.path.write_text(text.replace(old, new))
    return str(scene.path)


@pytest.mark.parametrize("name", [*scene_names(), *class_names(), *comparison_names()])
def test_a_shipped_scene_needs_no_group_in_its_name(name: str) -> None:
    assert load_scene(Path(name).name).path == load_scene(name).path


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ({"design": "lanes", "lanes": 4}, {"design": "engine", "lanes": 4}),
        ({"design": "lanes"}, {"design": "engine", "lanes": 2}),
        ({"design": "engine", "multiplier": "serial"}, {"design": "engine", "lanes": 0}),
        ({"multiplier": "dsp"}, {"lanes": 1}),
    ],
)
def test_older_words_of_the_engine_are_read_with_a_note(old: dict, new: dict, capsys) -> None:
    path = Path(f"{old}.toml")
    assert in_todays_words({"hardware": old}, path) == {"hardware": new}
    said = ", ".join(f"{key} = {value!r}" for key, value in new.items())
    assert capsys.readouterr().err == f"note: {path}: [hardware] is read as {said}\n"


@pytest.mark.parametrize(
    ("name", "text"),
    [("digit", "precise"), ("wine", "relu"), ("digit-sums", "functions in tables")],
)
def test_a_report_names_the_activation_of_the_networks(name: str, text: str) -> None:
    """The approximation of tanh is named where a network has tanh."""
    scene = load_scene(name)
    assert f", activation {text}, exact precision" in built(scene, scene.twin())[0]


def test_rows_are_chosen_by_the_values_of_columns(small_scene: Scene) -> None:
    lines = small_scene.data_path.read_text().splitlines()
    lines[3] = "0.25,0.5,0.1,0.5,0.5"
    lines[5] = "0.2500,0.5,0.2,0.6,0.6"
    lines[6] = "0.25,-0.5,0.3,1.5,0"
    small_scene.data_path.write_text("\n".join(lines))
    path = edited(small_scene, "[network]", "where = { x0 = 0.25, x1 = 0.5 }\n[network]")
    assert load_scene(path).vectors().inputs.tolist() == [[0.25, 0.5, 0.1], [0.25, 0.5, 0.2]]
    edited(small_scene, "x1 = 0.5", "x1 = -0.5")
    with pytest.raises(InputError, match=r"column 'y0': got a target of 1.5 in row 6, expected"):
        load_scene(path).vectors()


def test_every_shipped_scene_builds() -> None:
    for name in scene_names():
        scene = load_scene(name)
        assert scene.twin().outputs == len(scene.outputs)
        for path in scene.weights_paths:
            provenance = tomllib.loads(provenance_path(path).read_text())
            for key in ("optimiser", "seed", "restarts", "weight_decay", "steps", "patience"):
                assert provenance[key] == getattr(scene.training, key), key


@pytest.mark.parametrize(
    ("precision", "activation"), [("exact", "precise"), ("thesis", "gradient")]
)
def test_a_scene_that_names_no_activation_gets_that_of_its_precision(
    small_scene: Scene, precision: str, activation: str
) -> None:
    assert small_scene.activation == "gradient"
    edited(small_scene, 'activation = "gradient"\n', "")
    scene = load_scene(edited(small_scene, '"exact"', f'"{precision}"'))
    assert scene.activation == activation
    assert {a.block for a in scene.twin().activations} == {activation}


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
