"""The table of stiff and extreme cases is complete, all cases hold, and faults break them."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from pages import ROUNDING, SEARCHED

from golden.engine.formats import DROPPED
from golden.engine.program import Program
from golden.layers import input_integral
from golden.networks.engine import Engine
from golden.numbers.fixed import Fix
from golden.visualisation.power_fold import PowerFold
from studies.__main__ import recorded
from studies.stability import (
    conditioned,
    layered,
    networks,
    physics,
    study,
    visualisation,
)
from studies.stability.case import Row
from studies.stability.digits import deflection
from studies.stability.reference_swing import reference_swing
from tactus.physics.plate import Plate
from tactus.physics.swing import Swing, swing_motion
from tactus.recalibration import fit
from tactus.report.measure.table import Cell, Table
from tactus.train.descent import levenberg_marquardt

# A smaller error only consists of last bits.
UNSEEN = 1e-9


@pytest.fixture(scope="module")
def found() -> Table:
    return table_of(list(study.rows()))


def table_of(rows: list[dict[str, Cell]]) -> Table:
    return Table("stability", list(rows[0]), [list(row.values()) for row in rows], "")


@pytest.mark.all_only
def test_every_case_holds(found: Table) -> None:
    assert [row for row in found.rows if row[-1] != "yes"] == []
    assert all(value <= bound for *_, value, bound, _ in found.rows)


@pytest.mark.all_only
def test_the_result_is_what_is_measured(found: Table) -> None:
    """Last bits and errors of integrators depend on machines."""
    shown = recorded("stability").rows
    again = "make study NAME=stability RECORD=1, then docs/stability.md"
    assert [row[:4] for row in shown] == [row[:4] for row in found.rows], f"run: {again}"
    for before, now in zip(shown, found.rows, strict=True):
        assert before[5] == pytest.approx(now[5], rel=ROUNDING), f"{now}; run: {again}"
        pair = [float(row[4]) for row in (before, now)]
        assert max(pair) < UNSEEN or min(pair) >= (1 - SEARCHED) * max(pair), f"{now}; run: {again}"


@pytest.mark.parametrize("value", [2.0, float("nan"), float("inf")])
def test_a_case_that_breaks_its_bound_says_no(monkeypatch, value: float) -> None:
    rows = [Row("x", "a", "b", "y", value, 1.0), Row("x", "c", "b", "y", 1, 1)]
    monkeypatch.setattr(study, "CASES", (lambda: iter(rows),))
    made = table_of(list(study.rows()))
    assert [row[-1] for row in made.rows] == ["no", "yes"]
    assert made.rows[0][4] == (value if value == 2 else None)


def broken(cases) -> set[tuple[str, str]]:
    """The models and figures of cases that do not hold."""
    return {(row.model, row.figure) for row in cases() if not row.holds}


def test_a_hidden_sum_that_wraps_says_no(monkeypatch) -> None:
    """Adders of the thesis would wrap without normalisation."""
    right = input_integral.requantise

    def wrapping(codes, shift, target: Fix, rounding, overflow):
        return right(codes, shift, target, rounding, input_integral.Overflow.WRAP)

    monkeypatch.setattr(input_integral, "requantise", wrapping)
    found = broken(networks.rails)
    assert ("digit-hybrid", "codes off") in found
    assert ("digit-hybrid", "error in 2^-13") in found
    assert ("hybrid", "codes off") in broken(networks.huge_weights)


@pytest.mark.parametrize(
    ("fault", "cases", "figure"),
    [
        ("wrapping", layered.ranges, "codes off"),
        ("no ReLU", layered.dead, "error in 2^-13"),
        ("halves up", layered.ties, "codes off"),
    ],
)
def test_a_fault_in_several_layers_says_no(monkeypatch, fault: str, cases, figure: str) -> None:
    right = Program.run

    def broken_run(self, samples):
        for step, sums, word in right(self, samples):
            if fault == "wrapping":
                wrapped = ((sums >> DROPPED) + (1 << 17)) % (1 << 18) - (1 << 17)
                word[...] = np.where(step.relu, np.maximum(wrapped, 0), wrapped)
            yield step, sums, word

    def without_relu(self):
        return [replace(step, relu=0) for step in instructions(self)]

    instructions = Program.instructions.func
    if fault == "wrapping":
        monkeypatch.setattr(Program, "run", broken_run)
    elif fault == "no ReLU":
        monkeypatch.setattr(Program, "instructions", property(without_relu))
    else:
        monkeypatch.setattr(Engine, "process", _halves_up(Engine.process))
    assert ("deep engine", figure) in broken(cases)


def _halves_up(right):
    def process(self, frames):
        return replace(self, program=replace(self.program, even=False)).compute(frames)

    return process


def test_a_power_that_wraps_says_no(monkeypatch) -> None:
    def wrapping(self, exact, shift: int):
        return ((exact + ((1 << shift) >> 1)) >> shift) & ((1 << self.out_width) - 1)

    monkeypatch.setattr(PowerFold, "_rounded", wrapping)
    found = broken(visualisation.narrow_loads)
    assert {("power_fold", "error in LSB"), ("load_profile", "error in 2^-13")} <= found


@pytest.mark.parametrize("fault", ["stands still", "looser tolerance"])
def test_a_stiff_swing_that_is_solved_wrongly_says_no(monkeypatch, fault: str) -> None:
    right = physics.swing_motion

    def wrong(swing, start: float, *rest, **options):
        if fault == "looser tolerance":
            return right(swing, start, *rest, **options, tolerance=1e-4)
        motion = right(swing, start, *rest, **options)
        still = np.full_like(motion.angle, start)
        return replace(motion, angle=still, speed=np.zeros_like(still))

    monkeypatch.setattr(physics, "swing_motion", wrong)
    stiff = list(itertools.islice(physics.swings(), 9))
    assert [(row.case[:6], row.holds) for row in stiff if "error" in row.figure] == [
        ("damped", False)
    ] * 6
    if fault == "stands still":
        assert not any(row.holds for row in stiff)


def _normal_equations(aim, start, steps):
    slopes, errors = aim.jacobian(start), aim.residuals(start)
    return np.linalg.lstsq(slopes.T @ slopes, -slopes.T @ errors, rcond=1e-15)[0]


def _root_of_product(slopes):
    values, vectors = np.linalg.eigh(np.linalg.inv(slopes.T @ slopes))
    return vectors * np.sqrt(np.abs(values))


@pytest.mark.parametrize(
    ("module", "name", "fault", "cases", "model"),
    [
        (levenberg_marquardt, "descend", _normal_equations, "networks", "Levenberg-Marquardt"),
        (fit, "root_of_inverse", _root_of_product, "recalibration", "recalibration"),
    ],
)
def test_a_formula_that_loses_digits_says_no(
    monkeypatch, module, name: str, fault, cases: str, model: str
) -> None:
    monkeypatch.setattr(module, name, fault)
    assert model in {model for model, _ in broken(getattr(conditioned, cases))}


@pytest.mark.parametrize("rate", [0.1, 1e2, 1e6])
def test_the_judge_of_swings_agrees_with_a_third_family(rate: float) -> None:
    """Radau IIA at its least tolerance, where the judge does not know how well it does itself."""
    swing = Swing(damping=rate * Swing().arm)
    times = np.arange(200) / 100
    angle, speed, unsure = reference_swing(swing, 0.5, times)
    found = swing_motion(swing, 0.5, 2, 100, method="Radau", tolerance=1e-13)
    assert unsure < 1e-10
    assert np.abs(found.angle - angle).max() < 1e-13
    assert np.abs(found.speed - speed).max() < 1e-11


def test_the_deflection_in_more_digits_is_the_series_where_that_converges() -> None:
    """Far from the load the terms vanish; near the corner all four edges count."""
    for clamped in (True, False):
        sheet = replace(Plate(), clamped=clamped)
        point, load = (0.1, 0.05), (0.3, 0.4)
        exact = float(deflection(sheet, point, load))
        assert sheet.influence([point], [load])[0, 0] == pytest.approx(exact, rel=1e-11)
