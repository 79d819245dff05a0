"""Tests table clocks: every scene and its clocks."""

import re
from pathlib import Path

import pytest
from pages import section

from tactus.errors.scene_errors import scene_errors
from tactus.report.measure.clocks import clocks_per_frame
from tactus.report.measure.networks import scenes
from tactus.report.measure.table import Table
from tactus.scene import load_scene

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def table(measured_tables: dict[str, Table]) -> Table:
    return measured_tables["clocks"]


def by_scene(table: Table, name: str) -> dict[str, object]:
    at = table.columns.index(name)
    return {str(row[0]): row[at] for row in table.rows}


def test_every_scene_is_there(table: Table) -> None:
    assert [row[0] for row in table.rows] == [scene.name for scene in scenes()]


def test_the_worst_output_has_the_largest_error(table: Table) -> None:
    found = by_scene(table, "largest %")
    for name in ("digit-single-thesis", "swing-cascade"):
        errors = scene_errors(load_scene(name))["bit-true"]
        assert found[name] == max(error.largest_mean for error in errors)


@pytest.mark.parametrize(
    ("name", "beside"),
    [("digit-single", 4 + 4), ("digit-hybrid", 7 + 4), ("digit-parallel", 1 + 1)],
)
def test_samples_and_outputs_take_a_clock_each(name: str, beside: int) -> None:
    """The frame of a cascade also has slots for earlier outputs. In parallel all come at once."""
    design = load_scene(name).twin()
    assert clocks_per_frame(design) == design.latency + beside - 1


def test_an_instrument_waits_for_its_sensors(table: Table) -> None:
    found = by_scene(table, "clocks a frame")
    scan = load_scene("digit-instrument").twin().scan_sequencer
    assert found["digit-instrument"] > scan.sample_clocks[-1] > 10 * found["digit"]
    assert by_scene(table, "interval clocks")["digit-instrument"] == scan.scan_clocks


def test_an_engine_waits_for_its_program() -> None:
    """Its outputs leave when they are computed, so the last leaves some clocks after the first."""
    design = load_scene("digit").twin()
    first, *_, last = design.output_clocks
    assert clocks_per_frame(design) == 4 + last
    assert last - first > 3


def test_a_cascade_pays_clocks_for_accuracy(table: Table) -> None:
    """No part of the error is promised in advance. The figures of the page are those of the table.

    The networks of the thesis have the hidden nodes that it prints, so a cascade wins less there.
    """
    largest, frame = by_scene(table, "largest %"), by_scene(table, "clocks a frame")
    page = " ".join(section("figures", "clocks").split())
    pairs = {"digit-hybrid": "digit-single", "digit-thesis": "digit-single-thesis"}
    for cascade, single in pairs.items():
        form = rf"`{cascade}` takes (\d+) clocks .*?by ([\d.]+) times .*?`{single}`.*? (\d+)"
        (shown,) = re.findall(form, page)
        part = f"{largest[cascade] / largest[single]:.2f}"
        assert shown == (f"{frame[cascade]}", part, f"{frame[single]}")
        assert largest[cascade] < largest[single]
    assert largest["digit-a"] > largest["digit-hybrid"]
    assert largest["digit-thesis-a"] > largest["digit-thesis"]
