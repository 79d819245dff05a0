"""The table at the end of ``make demo`` has the figures of its scenes and of the thesis."""

from __future__ import annotations

from typing import Any

import pytest
from pages import ROUNDING, shows

from tactus.errors import held_out_means, scene_errors
from tactus.report.measure.networks import clocks_per_frame
from tactus.report.page.side_by_side import KINDS, side_by_side
from tactus.scene import DEFAULT_SCENES, Scene, load_scene, thesis_table
from tactus.synth.budget import read_budget
from tactus.verify.benches.tools import SIMULATORS


@pytest.fixture(scope="module")
def scenes() -> list[Scene]:
    return [load_scene(name) for name in DEFAULT_SCENES]


@pytest.fixture(scope="module")
def table(scenes: list[Scene]) -> list[str]:
    return side_by_side(scenes)


def found(scene: Scene, **others: Any) -> dict[str, Any]:
    """Possible results of the benches."""
    facts = {"clocks_per_frame": 12345, "interval": 54321, "frames": 10, "seconds": 2.0}
    blocks = {"abs_unit": {simulator: [1, 70] for simulator in SIMULATORS}}
    results = {
        "benches": 9,
        "kept": 0,
        "left": 0,
        "recorded": [],
        "short": "",
        "failed": 0,
        "compared": 987654,
    }
    own = {"facts": dict.fromkeys(SIMULATORS, facts), "blocks": blocks}
    return results | own | others


def row(table: list[str], name: str) -> str:
    """The text after the first cell of the line with this name."""
    (line,) = [line for line in table if line.strip().startswith(name + "  ")]
    return line.strip().removeprefix(name)


def test_errors_are_those_of_the_scenes_and_of_the_thesis(
    scenes: list[Scene], table: list[str]
) -> None:
    printed = thesis_table("digit.cascade_b")["simulation"]
    for n, name in enumerate(scenes[0].outputs):
        figures = [printed[n]]
        for scene in scenes:
            error, held_out = scene_errors(scene)["bit-true"][n], held_out_means(scene)
            assert held_out is not None
            figures += [error.mean, error.largest_mean, held_out[n]]
        cells = row(table, name).split()
        for text, figure in zip(cells, figures, strict=True):
            assert shows(text, figure, ROUNDING), name


def test_clocks_are_those_of_the_twins_or_those_that_were_simulated(
    scenes: list[Scene], table: list[str]
) -> None:
    counts = [f"{clocks_per_frame(scene.twin()):,}" for scene in scenes]
    assert row(table, "clocks a frame").split() == ["-", *counts]
    board = thesis_table("board")
    first, *others = row(table, "clocks between frames").replace(" us)", "us)").split()[::2]
    assert first == f"{2 ** board['scan_counter_bits']:,}"
    assert others == [f"{scene.twin().interval:,}" for scene in scenes]
    simulated = side_by_side(scenes, {scene.name: found(scene) for scene in scenes})
    assert row(simulated, "clocks a frame").split() == ["-", "12,345", "12,345"]
    assert row(simulated, "clocks between frames").count("54,321") == len(scenes)


def test_what_was_compared_is_told_where_benches_ran(scenes: list[Scene], table: list[str]) -> None:
    assert not any("values compared" in line for line in table)
    results = {scene.name: found(scene) for scene in scenes}
    results[scenes[1].name] = found(scenes[1], failed=3)
    told = row(side_by_side(scenes, results), "values compared")
    assert "987,654, none differ" in told
    assert "987,654, 3 benches red" in told


@pytest.mark.parametrize("kind", KINDS)
def test_cells_are_those_that_were_recorded(
    scenes: list[Scene], table: list[str], kind: str
) -> None:
    cells = [c for c in row(table, f"{kind}s").split() if "(" not in c and c not in ("about", "%)")]
    tops = [read_budget(s.path)["xc2v"][s.twin().entity] for s in scenes]
    assert cells[1:] == [f"{top[kind]:,}" for top in tops]
    device, printed = thesis_table("device"), thesis_table("digit.cascade_b")
    expected = {
        "LUT": device["luts4"] * printed["luts_percent"] / 100,
        "multiplier": device["mult18x18"] * printed["mult18x18_percent"] / 100,
    }
    assert cells[0] == (f"{expected[kind]:,.0f}" if kind in expected else "-")
