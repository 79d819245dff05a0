"""Tests what is read of a scene, its schema for editors, and the shipped scenes."""

import json
import re
import tomllib
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft7Validator

from golden.common.block import walk
from golden.input_error import InputError
from tactus.boards.board import BOARD
from tactus.boards.board import FOLDER as BOARDS
from tactus.core.finding import faults
from tactus.core.schema import REQUIRED, Key, KeyTable, json_schema
from tactus.network_files.network_file import read_provenance
from tactus.physics.gauges import FOLDER as RIGS
from tactus.physics.gauges import RIG
from tactus.report.page.summary import built
from tactus.rig.check import everything
from tactus.scene import (
    DEFAULT_SCENES,
    Scene,
    class_names,
    comparison_names,
    load_scene,
    scene_names,
    scene_path,
)
from tactus.scene.codes import saturating
from tactus.scene.reading import EDITOR_SCHEMA, SCENE


def edited(scene: Scene, old: str, new: str) -> str:
    """Replace a text in the file of the scene, and return its path."""
    text = scene.path.read_text()
    assert old in text
    scene.path.write_text(text.replace(old, new))
    return str(scene.path)


def test_a_shipped_scene_needs_no_group_in_its_name() -> None:
    for name in (*scene_names(), *class_names(), *comparison_names()):
        assert load_scene(Path(name).name).path == load_scene(name).path


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


@pytest.mark.parametrize("name", scene_names())
def test_a_shipped_scene_has_no_faults(name: str, tmp_path: Path) -> None:
    scene = load_scene(name)
    twin = scene.twin()
    assert twin.outputs == len(scene.outputs)
    entities = [block.entity for block in walk(twin)]
    assert len(set(entities)) == len(entities)
    for path in scene.weights_paths:
        provenance = read_provenance(path)
        for key in ("optimiser", "seed", "restarts", "weight_decay", "steps", "patience"):
            assert provenance[key] == getattr(scene.training, key), key
    assert not list(saturating(scene))
    # Whether 5000 rows of each sensor tell something takes long to find.
    if not name.startswith("swing"):
        assert not faults(everything(scene, tmp_path))


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


def test_the_default_scenes_have_the_same_sensors_and_outputs() -> None:
    first, *others = map(load_scene, DEFAULT_SCENES)
    for other in others:
        assert (other.sensors, other.outputs) == (first.sensors, first.outputs)
        assert (other.data_paths, other.reference) == (first.data_paths, first.reference)


SCENES = [scene_path(name) for name in (*scene_names(), *class_names(), *comparison_names())]
FILES = [
    *((SCENE, path) for path in SCENES),
    *((BOARD, path) for path in sorted(BOARDS.glob("*.toml"))),
    *((RIG, path) for path in sorted(RIGS.glob("*.toml"))),
]
# Values of each type, at the ends of spans and beyond, and choices that exist or do not.
VALUES: list[Any] = [
    *(True, False, -1, 0, 1, 7, 24, 25, 1024, 1025, 100_001, 1_000_001, -0.5, 0.5, 1.0001, 150.5),
    *(1e-5, 10_000.5, "", "a", "auto", "fewest", "scg", "engine", "exact", "mcp3208"),
    *([], [0], [1, 3], [0, 65_537], [1, 2, 3], ["a"], ["a", "a"], [""], [["a"]], [1.5], ["a", 1]),
    *({}, {"a": 1}, {"a": "b"}, {"a": "auto"}, {"a": [0]}, {"a": ["b"]}, {"a": 0}, {"a": {}}),
    *({"gain": 1}, {"gain": 101}, {"gian": 1}, {"a": {"factor": 2}}, {"a": {"factor": 0}}),
    *({"a": {"offset": 2}}, {"a": {"factor": 2, "offset": 1}}, {"position": 1}, {"width": 0}),
]


def sections(table: KeyTable) -> Iterator[tuple[str, Key]]:
    """Every key within a table, with its place. A table comes after the keys in it."""
    for name, key in table.keys.items():
        if isinstance(key.kind, KeyTable):
            yield from ((f"{name}.{inner}", below) for inner, below in sections(key.kind))
        yield name, key


KEYS = [(name, key) for table in (SCENE, BOARD, RIG) for name, key in sections(table)]


@pytest.mark.parametrize(("table", "path"), FILES, ids=lambda part: getattr(part, "stem", ""))
def test_every_shipped_file_is_accepted(table: KeyTable, path: Path) -> None:
    schema = json.loads(json_schema(table, "any"))
    Draft7Validator.check_schema(schema)
    raw = tomllib.loads(path.read_text(encoding="utf-8"))
    assert not [error.message for error in Draft7Validator(schema).iter_errors(raw)]


def test_schema_and_check_agree() -> None:
    """They agree on every value: the schema marks just the values that the check refuses."""
    for (name, key), value in product(KEYS, VALUES):
        judge = Draft7Validator(key.kind.schema())
        found = list(key.kind.faults(value, name))
        assert judge.is_valid(value) == (not found), (value, found)
        assert all(fault.startswith(name) for fault in found), found


def test_a_default_is_what_may_stand_there() -> None:
    """Values that stand for a missing key are an exception."""
    for name, key in KEYS:
        if key.default not in (REQUIRED, None, "", [], {}) and (key.default or not key.kind.absent):
            assert not list(key.kind.faults(key.default, name))


def test_every_key_has_a_meaning_that_an_editor_can_show() -> None:
    schema = json.loads(EDITOR_SCHEMA.read_text(encoding="utf-8"))
    for section, key in SCENE.keys.items():
        for name, inner in key.kind.keys.items():
            assert inner.meaning, name
            shown = schema["properties"][section]["properties"][name]
            assert not re.search(r"`|\]\(", shown["description"])
