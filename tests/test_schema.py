"""Tests that the check, the schema for editors and the page of a TOML file agree."""

import json
import re
import tomllib
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft7Validator

from golden.input_error import InputError
from tactus.boards.board import BOARD
from tactus.boards.board import FOLDER as BOARDS
from tactus.core.schema import REQUIRED, Key, KeyTable, Span, json_schema
from tactus.physics.gauge_rig import FOLDER as RIGS
from tactus.physics.gauge_rig import RIG
from tactus.report.page import lists
from tactus.scene import FOLDER, class_names, comparison_names, load_scene, scene_names, scene_path
from tactus.scene.reading import EDITOR_SCHEMA, SCENE

SCHEMA = json.loads(EDITOR_SCHEMA.read_text(encoding="utf-8"))
JUDGE = Draft7Validator(SCHEMA)
SCENES = [scene_path(name) for name in (*scene_names(), *class_names(), *comparison_names())]
DIGIT = FOLDER / "digit" / "digit.toml"
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


def judged(text: str) -> list[str]:
    return [error.message for error in JUDGE.iter_errors(tomllib.loads(text))]


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


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("[hardware]", "[hardwear]", "'hardwear' was unexpected"),
        ('design = "engine"\n', "", "'design' is a required property"),
        ('design = "engine"', 'design = "engin"', "'engin' is not one of"),
        ('sensors = ["sensor1"', 'sensors = ["sensor4"', "has non-unique elements"),
        ("[training]", "[training]\nsteps = 2.5", "2.5 is not of type 'integer'"),
        ("[training]", '[training]\ndigits = "few"', "'few' is not valid under any"),
        ("[training]", "[training]\ndrift = { gian = 1 }", "'gian' was unexpected"),
    ],
)
def test_an_editor_sees_what_the_check_refuses(
    tmp_path: Path, old: str, new: str, says: str
) -> None:
    text = re.sub(r"^(restarts|steps|refit|digits).*\n", "", DIGIT.read_text(), flags=re.M)
    assert not judged(text)
    assert old in text
    text = text.replace(old, new, 1)
    assert any(says in message for message in judged(text)), judged(text)
    path = tmp_path / "mine.toml"
    path.write_text(text)
    with pytest.raises(InputError, match=r"mine\.toml: "):
        load_scene(str(path))


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


def test_the_schema_is_that_of_the_declaration() -> None:
    again = f"run: {lists.COMMAND}"
    assert EDITOR_SCHEMA.read_text(encoding="utf-8") == lists.editor_schema(), again
    for section, key in SCENE.keys.items():
        for name, inner in key.kind.keys.items():
            shown = SCHEMA["properties"][section]["properties"][name]
            assert inner.meaning, name
            assert not re.search(r"`|\]\(", shown["description"])


@pytest.mark.parametrize(
    ("span", "text"),
    [
        (Span(0), "0 or more"),
        (Span(1, 24), "1 to 24"),
        (Span(-1, below=1), "-1 to below 1"),
        (Span(above=0), "above 0"),
        (Span(above=0, most=1_000_000), "above 0 and 1000000 at most"),
        (Span(above=0, below=1), "above 0 and below 1"),
    ],
)
def test_a_span_says_which_numbers_it_holds(span: Span, text: str) -> None:
    assert str(span) == text
    judge = Draft7Validator(span.schema())
    for number in (-2, -1, 0, 1e-9, 0.5, 1, 24, 25, 1_000_000, 1_000_001):
        assert span.holds(number) == judge.is_valid(number)
    assert not any(map(span.holds, (float("nan"), float("inf"), float("-inf"))))
