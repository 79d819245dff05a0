"""Tests on_line_learning and beyond_drift: rows, how they are measured, what the page concludes."""

import numpy as np
import pytest
from pages import DOCS, cells, section

from golden.learning import steps
from golden.learning.costs import ENGINE, PARTS, equation_steps, square_root_steps
from golden.learning.unit import Unit
from golden.networks.engine import Engine
from golden.scene import load_scene
from hdl.synth.budget import budget_path, read_budget
from tb.report.measure import beyond_drift as beyond
from tb.report.measure import table_records
from tb.report.measure.on_line_learning import (
    CLOCK,
    COMPUTER,
    COUNTS,
    DRAWS,
    KACZMARZ,
    LMS,
    NOISES,
    NONE,
    RECURSIVE,
    RULES,
    Draws,
    Rule,
    draws,
    learned,
    lost,
    uncorrected,
)

pytestmark = pytest.mark.pages

PERTURBATION = "perturbation (SPSA)", 2000
CONJUGATE = "conjugate gradients, 36 bits"
OUTPUTS = load_scene("digit").outputs
MOST = max(COUNTS)
NOISY = max(NOISES)
BY_NAME = {(rule.name, rule.passes): rule for rule in RULES}
Row = dict[str, float]


@pytest.fixture(scope="module")
def rows() -> dict[tuple[str, int | None, float, int], Row]:
    table = table_records.read("on_line_learning")
    return {
        (row[0], row[1], row[2], row[3]): dict(zip(table.columns[4:], row[4:], strict=True))
        for row in table.rows
    }


@pytest.fixture(scope="module")
def drawn() -> Draws:
    return draws(table_records.SEED, (NOISY,))


def medians(row: Row) -> list[float]:
    return [row[f"{output} %"] for output in OUTPUTS]


def test_every_rule_has_every_noise_and_number_of_placements(rows) -> None:
    names = [(NONE, None), (COMPUTER, None), *BY_NAME]
    expected = {(*one, 1e3 * noise, count) for one in names for noise in NOISES for count in COUNTS}
    assert set(rows) == expected
    for row in rows.values():
        for output in OUTPUTS:
            assert row[f"{output} from %"] <= row[f"{output} %"] <= row[f"{output} to %"]


def test_times_is_the_largest_ratio_to_recalibration(rows) -> None:
    for (_, _, noise, count), row in rows.items():
        computer = medians(rows[COMPUTER, None, noise, count])
        ratios = np.array(medians(row)) / computer
        assert row["times"] == pytest.approx(ratios.max())


def test_what_is_shown_is_what_recalibrate_proposes(drawn: Draws) -> None:
    """The placements are the same for all drifts of a noise, and none is shown twice."""
    assert drawn.shown.shape == (DRAWS, MOST)
    assert (drawn.shown == drawn.shown[0]).all()
    assert len(set(drawn.shown[0])) == MOST
    noise = drawn.noisy - np.take_along_axis(drawn.readings, drawn.shown[..., np.newaxis], 1)
    assert noise.std() == pytest.approx(NOISY, rel=0.1)
    lesson = drawn.lesson(4)
    assert (len(lesson), lesson.drifts) == (4, DRAWS)


def test_errors_are_of_rows_that_were_not_shown(drawn: Draws) -> None:
    vectors = drawn.scene.vectors()
    outputs = np.zeros((len(vectors.codes), len(OUTPUTS)), dtype=np.int64)
    errors = vectors.percent_errors(outputs / 2.0**13)
    rows = drawn.shown[0, :5]
    hidden = np.delete(errors, rows, axis=0)
    np.testing.assert_array_equal(drawn.worst(outputs, 0, 5), hidden.max(axis=0))


def near(rows, name: str, passes: int | None, count: int, found: np.ndarray) -> None:
    """On another processor a drift may differ in its last bit, and a code with it."""
    recorded = medians(rows[name, passes, 1e3 * NOISY, count])
    np.testing.assert_allclose(np.median(found, axis=0), recorded, rtol=0.1)


def test_the_drift_is_measured_again(rows, drawn: Draws) -> None:
    near(rows, NONE, None, MOST, uncorrected(drawn, MOST))


def test_a_rule_is_measured_again(rows, drawn: Draws) -> None:
    name, passes, count = RECURSIVE, 1, 8
    rule: Rule = BY_NAME[name, passes]
    found = learned(rule, drawn, count)
    near(rows, name, passes, count, found.worst)
    row = rows[name, passes, 1e3 * NOISY, count]
    assert row["clocks"] == found.unit.clocks
    assert row["steps"] == round(found.unit.steps / (passes * count))
    assert row["words"] == rule.memory(count)


def test_what_does_not_fit_is_told() -> None:
    unit = Unit(2)
    unit.word("some", np.array([[1 << 40, 0], [0, 0]]), 1)
    unit.word("hidden sum", np.array([[1 << 40], [0]]), 1)
    assert lost(unit, slice(0, 1)) == "some 50 %"
    assert lost(unit, slice(0, 2)) == "some 25 %"
    assert lost(unit, slice(1, 2)) == "-"


def test_luts_stand_on_what_is_built() -> None:
    digit, instrument = (load_scene(name).path for name in ("digit", "digit-instrument"))
    assert read_budget(budget_path(digit))["xc2v"]["engine"]["LUT"] == ENGINE
    divider = read_budget(budget_path(instrument))["xc2v"]["divider"]["LUT"]
    assert PARTS["quotient"] == PARTS["square root"] == divider


def test_the_page_counts_the_steps_of_the_program(drawn: Draws) -> None:
    program = steps.lms(drawn.setting.taught, [(1, 0)] * 4)
    counted = steps.counted(program)
    page = section("learning", "As a program of an engine")
    for kind in steps.Kind:
        assert cells(page, kind.value)[0] == str(counted[kind])
    total = sum(counted.values())
    assert f"is {total} steps" in page
    assert f"make it {404 + 20 + total}" in page
    equations = sum(
        equation_steps(4, output, mlp.shape[1]) for output, mlp in enumerate(drawn.scene.mlps())
    )
    assert f"{404 + 20 + equations + square_root_steps(8):,} in all" in page
    digit = load_scene("digit").twin()
    assert isinstance(digit, Engine)
    assert len(digit.program.table) + len(digit.program.words) == 404


def times(rows, name: str, passes: int, count: int = MOST) -> float:
    """The largest ratio to recalibration over all noises."""
    return max(rows[name, passes, 1e3 * noise, count]["times"] for noise in NOISES)


def test_the_rules_that_could_be_built_reach_the_aim(rows) -> None:
    """1.5 times the error of make recalibrate, within a second, 400 LUTs and an accumulator."""
    for name, passes in ((LMS, 400), (RECURSIVE, 3)):
        assert times(rows, name, passes) < 1.5
        row = rows[name, passes, 0, MOST]
        assert row["clocks"] < CLOCK
        assert row["LUTs"] <= 400
        assert row["sum bits"] <= 48


def test_what_the_page_concludes_is_in_the_record(rows) -> None:
    page = (DOCS / "learning.md").read_text(encoding="utf-8").partition("## What is learned")[0]
    page = " ".join(page.split())
    best = times(rows, RECURSIVE, 3)
    assert f"recursive least squares {best:.2f} times" in page
    assert f"conjugate gradients {times(rows, CONJUGATE, 3):.2f} times" in page
    assert f"LMS with a constant step {times(rows, LMS, 400):.2f} times" in page
    quiet = rows[RECURSIVE, 1, 0, MOST]
    worst = max(quiet[f"{output} to %"] for output in OUTPUTS)
    assert f"up to {worst:.0f} %" in page
    few = [times(rows, name, n, c) for name, n in ((RECURSIVE, 3), (LMS, 400)) for c in (4, 8, 12)]
    assert f"up to {max(few):.1f} times" in page
    assert f"needs no derivatives, {times(rows, *PERTURBATION):.2f} times" in page
    assert best == min(times(rows, *one) for one in BY_NAME if "own outputs" not in one[0])


def test_output_layers_cannot_undo_a_drift(rows) -> None:
    layers = [one for one in BY_NAME if one[0].startswith("output layers")]
    assert len(layers) == 4
    others = [one for one in BY_NAME if one not in layers and one[1] > 1]
    assert min(times(rows, *one) for one in layers) > 4 * max(times(rows, *one) for one in others)


def test_wider_words_gain_nothing_but_for_conjugate_gradients(rows) -> None:
    for narrow, wide in (
        ((KACZMARZ, 100), ("Kaczmarz, theta in 32 bits", 100)),
        ((RECURSIVE, 1), ("recursive least squares, square root, 36 bits", 1)),
    ):
        assert times(rows, *wide) > 0.95 * times(rows, *narrow)
    assert times(rows, CONJUGATE, 3) < 0.75 * times(rows, "conjugate gradients, 18 bits", 3)
    assert rows[CONJUGATE, 3, 0, MOST]["sum bits"] > 48


@pytest.fixture(scope="module")
def changes() -> dict[tuple[str, str], Row]:
    table = table_records.read("beyond_drift")
    return {
        (row[0], row[1]): dict(zip(table.columns[2:], row[2:], strict=True)) for row in table.rows
    }


def test_every_change_has_every_correction(changes) -> None:
    names = [change.name for change in beyond.CHANGES]
    assert list(changes) == [(name, by) for name in names for by in (NONE, COMPUTER, LMS)]


def test_a_change_of_nothing_is_the_recording() -> None:
    vectors = load_scene("digit").vectors()
    same = beyond.changed(beyond.CHANGES[0], vectors)
    np.testing.assert_array_equal(same.codes, vectors.codes)
    np.testing.assert_array_equal(same.targets, vectors.targets)


def test_a_thicker_beam_is_a_gain_of_the_gauges() -> None:
    """1 / t^2 of what they read beside their offsets; sensor 4 is no gauge on the beam."""
    vectors = load_scene("digit").vectors()
    inside = (np.abs(vectors.inputs) < 0.9).all(axis=1)
    thicker = beyond.changed(beyond.CHANGES[1], vectors)
    moved = (thicker.inputs - vectors.inputs)[inside]
    np.testing.assert_allclose(moved[:, 3], 0, atol=1e-12)
    slopes = [np.polyfit(vectors.inputs[inside, k], moved[:, k], 1)[0] for k in range(3)]
    np.testing.assert_allclose(slopes, 1 / 1.05**2 - 1, rtol=0.05)


def test_new_widths_are_in_no_row() -> None:
    vectors = load_scene("digit").vectors()
    (change,) = (one for one in beyond.CHANGES if one.name.startswith("widths"))
    new = beyond.changed(change, vectors).targets[:, 2]
    assert not set(np.round(new, 4)) & set(np.round(vectors.targets[:, 2], 4))


def near_change(changes, number: int, names: tuple[str, ...]) -> None:
    change = beyond.CHANGES[number]
    drawn = beyond.draws(change, table_records.SEED)
    if names == (NONE,):
        found = {NONE: uncorrected(drawn, beyond.SHOWN)}
    else:
        found = beyond.corrected(drawn)
    for name in names:
        recorded = medians(changes[change.name, name])
        np.testing.assert_allclose(np.median(found[name], axis=0), recorded, rtol=0.1)


@pytest.mark.parametrize("number", range(len(beyond.CHANGES)))
def test_changes_are_measured_again(changes, number: int) -> None:
    near_change(changes, number, (NONE,))


def test_what_the_page_says_of_changes_is_in_the_record(changes) -> None:
    def errors(change: str, name: str) -> np.ndarray:
        return np.array(medians(changes[change, name]))

    thick = "a beam 5 % thicker"
    assert (errors(thick, LMS) < 1.6 * errors(thick, COMPUTER)).all()
    assert (errors(thick, LMS) < errors(thick, NONE) / 3).all()
    far = "a beam 20 % thicker"
    assert (errors(far, LMS) > 1.5 * errors(far, COMPUTER)).all()
    for change in ("gauges moved by 2 mm", "gauges moved by 10 mm"):
        for name in (COMPUTER, LMS):
            better = errors(change, name) < errors(change, NONE)
            assert better.tolist() == [False, True, False, False]
    widths = "widths between the trained ones"
    for name in (COMPUTER, LMS):
        assert (errors(widths, name) > errors(widths, NONE)).all()
        assert (errors("loads of 3 to 6 g", name)[1:] > 25).all()
