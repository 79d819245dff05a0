"""Tests what is read of a scene: its rows, its networks and what it leaves out."""

import tomllib
from pathlib import Path

import pytest

from golden.input_error import InputError
from tactus.network_files.network_file import provenance_path
from tactus.report.page.summary import built
from tactus.scene import Scene, comparison_names, load_scene, scene_names
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
