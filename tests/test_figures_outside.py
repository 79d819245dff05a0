"""Tests the recorded table outside: the target of each rig, and the figures of the page."""

import numpy as np
import pytest

from tactus.core.table import read_table
from tactus.report.measure import outside, table_records

pytestmark = pytest.mark.pages

RIGS = ("digit", "tutorial", "bar")
COLUMNS = {f"{100 * part:g} %": part for part in outside.FALSE_ALARMS}


@pytest.fixture(scope="module")
def rows() -> dict[tuple[str, str], dict[str, float]]:
    table = table_records.read("outside")
    return {
        (str(row[0]), str(row[1])): dict(zip(table.columns[2:], row[2:], strict=True))
        for row in table.rows
    }


@pytest.mark.parametrize("rig", RIGS)
def test_at_one_false_alarm_in_a_hundred_the_targets_are_met(rows, rig: str) -> None:
    assert rows[rig, "columns swapped"]["1 %"] >= 95
    assert rows[rig, outside.OUTSIDE]["1 %"] >= 99


def test_more_false_alarms_see_more(rows) -> None:
    for (_, kind), figures in rows.items():
        if kind != "good":
            found = [figures[column] for column in COLUMNS]
            assert found == sorted(found)


def test_at_its_limit_good_frames_are_inside(rows) -> None:
    """The digit is an exception, as its limit depends on eight stretches. The page says so."""
    for rig in RIGS[1:]:
        assert rows[rig, "good"]["at its limit"] <= 1
        assert rows[rig, "columns swapped"]["at its limit"] >= 95
    assert rows["digit", "good"]["at its limit"] <= 20


def test_the_rail_is_that_of_the_tutorial() -> None:
    """Its readings equal those of docs/tutorial, with their noise."""
    names = ["s1", "s2", "s3", "s4", "s5", "force", "place"]
    table = read_table(outside.RAIL.with_name("readings.csv"), names)
    again = outside.rail(table[:, 5:], np.random.default_rng(1))
    assert np.abs(table[:, :5] - again).max() < 2e-4


def test_touches_beyond_are_beyond() -> None:
    rng = np.random.default_rng(1)
    touches = outside.touches_beyond((0.0, 2.0), (10.0, 20.0), 300, rng)
    far = np.maximum(np.abs(touches[:, 0] - 1) / 2, np.abs(touches[:, 1] - 15) / 10) - 0.5
    assert (far >= 0.5 - 1e-12).all()
    assert (far <= 0.75).all()


def test_every_sensor_and_pair_is_spoilt_alone() -> None:
    plain = np.arange(12.0).reshape(3, 4)
    kinds = outside.spoilings(plain, np.zeros(4), np.full(4, 12.0), np.random.default_rng(1))
    assert len(kinds["columns swapped"]) == 6 * 3
    for kind, frames in kinds.items():
        changed = (frames.reshape(-1, 3, 4) != plain).any(axis=1)
        assert (changed.sum(axis=1) == (2 if kind == "columns swapped" else 1)).all()
