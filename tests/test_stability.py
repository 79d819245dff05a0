"""The table of stiff and extreme cases is complete, all cases hold, and faults break them."""

import itertools
import re
from dataclasses import replace

import numpy as np
import pytest
from pages import ROUNDING, SEARCHED

from golden.activation.abs_unit import AbsUnit
from golden.activation.comparator_bank import ComparatorBank
from golden.activation.sign_retriever import SignRetriever
from golden.engine.formats import DROPPED
from golden.engine.graph import Graph
from golden.engine.program import Program
from golden.layers import input_integral
from golden.layers.weighted_sum import WeightedSum
from golden.networks import engine
from golden.networks.designs import DESIGNS
from golden.networks.engine import Engine
from golden.numbers.fixed import Fix
from golden.visualisation.power_fold import PowerFold
from studies.__main__ import recorded
from studies.stability import (
    activations,
    conditioned,
    layered,
    networks,
    physics,
    study,
    visualisation,
)
from studies.stability.case import Row, accepted, largest
from studies.stability.digits import deflection
from studies.stability.reference_swing import reference_swing
from tactus.physics.plate import Plate
from tactus.physics.swing import Swing, swing_motion
from tactus.recalibration import fit
from tactus.report.measure.table import Cell, Table
from tactus.scene import scene_names
from tactus.train.descent import levenberg_marquardt

# A smaller error only consists of last bits.
UNSEEN = 1e-9
WINDOWS = ("swing-window", "swing-window-cascade")
LAYERS = ("relu, relu, relu", "leaky_relu, linear, leaky_relu", "sigmoid, hard_tanh, tanh")
ROUNDINGS = ("even", "away", "floor")
# The cases that must exist: a model, and words in the name of the case.
NAMED = [
    *((name, "all sensors at rails") for name in scene_names()),
    *((name, "^alternating rails") for name in WINDOWS),
    *((name, "^rails in the past") for name in WINDOWS),
    *((name, "^a sensor that stopped") for name in WINDOWS),
    ("abs_unit", r"^-1 in Fix\(14,13\)"),
    ("abs_unit", r"^-8 in Fix\(18,14\)"),
    *((name, "most negative code, thesis") for name in ("gradient", "lut", "pade", "polynomial")),
    ("precise", "most negative code"),
    *(
        (name, rf"Q_j to 2\d\d, {p}")
        for name, design in DESIGNS.items()
        for p in design.precisions
        if not design.learned_functions
    ),
    ("constants", "Q_j of 200000, thesis"),
    *(("deep engine", f"^{kinds}: all sensors at rails") for kinds in LAYERS),
    *(("deep engine", f"^{kind}, {kind}: all weights") for kind in ("relu", "linear")),
    ("deep engine", "^tanh, tanh: all weights"),
    ("deep engine", "^every ReLU of layer 1 is dead"),
    ("deep engine", r"^relu: [1-9]\d* sums half way"),
    *(("deep engine", rf"^quantised, {r}: [1-9]\d* sums half way") for r in ROUNDINGS),
    ("deep engine", "relu, ranges from the data: recorded frames"),
    ("deep engine", "relu, ranges from the data: frames that leave them"),
    *((name, "ends, thesis") for name in ("input_integral", "neuron", "output_integral")),
    *((name, "ends, exact") for name in ("input_integral", "neuron", "output_integral")),
    ("pade", "rho = 1 and 2, 2 to 200 iterations, thesis"),
    ("pade", "rho = 1 and 2, 2 to 200 iterations, exact"),
    ("pade", "floating point"),
    ("plate", "10000 terms, 0 to 1e-09 of its sides from the load, clamped"),
    ("plate", "b / a of 0.01"),
    ("swing", r"damped at 1e\+06"),
    ("swing", "arm of 0.001 m"),
    ("swing", "from 179.9 degrees"),
    ("swing", "1000 periods undamped"),
    ("load_profile", "P = 6, width of .* or 1 codes"),
    *((name, "all at their limits, .*, exact") for name in ("engine", "hybrid", "lanes")),
    ("hybrid", "all at their limits, .*, thesis"),
    ("power_fold", "P = 6, every t"),
    ("equation 3.17", "^0 to 1e-06 from its jumps"),
    ("readings", "NaN"),
    ("frames", "too short"),
    ("conditioning", "alternating rails"),
    ("physics", "NaN"),
    ("Levenberg-Marquardt", "^lambda 0, Jacobians of digit"),
    ("Levenberg-Marquardt", "a singular Jacobian"),
    ("smooth map", "one sensor twice, one dead, two nearly alike"),
    ("Cramer-Rao", "one of them twice"),
    ("Cramer-Rao", "likelihood of known loads"),
    ("recalibration", "^one placement"),
    ("recalibration", "^24 equal ones, drift of 100"),
    ("DC remover", "^0.06 Hz at 15625"),
    ("gradient", "^steep node"),
    ("board that learns", "three equations"),
]


@pytest.fixture(scope="module")
def found() -> Table:
    return table_of(list(study.rows()))


def table_of(rows: list[dict[str, Cell]]) -> Table:
    return Table("stability", list(rows[0]), [list(row.values()) for row in rows], "")


def test_the_columns(found: Table) -> None:
    assert list(found.columns) == ["model", "case", "must", "figure", "value", "bound", "holds"]
    assert all(text for row in found.rows for text in row[:4])


@pytest.mark.parametrize(("model", "case"), NAMED)
def test_every_case_that_is_asked_for_is_there(found: Table, model: str, case: str) -> None:
    rows = [row for row in found.rows if model in str(row[0]).split(", ")]
    assert [row for row in rows if re.search(case, str(row[1]))]


def test_every_case_holds(found: Table) -> None:
    assert [row for row in found.rows if row[-1] != "yes"] == []
    assert all(value <= bound for *_, value, bound, _ in found.rows)


def test_no_case_repeats_another(found: Table) -> None:
    keys = [tuple(row[1:6]) for row in found.rows]
    assert len(set(keys)) == len(keys)


def test_the_result_is_what_is_measured(found: Table) -> None:
    """Last bits and errors of integrators depend on machines."""
    shown = recorded("stability").rows
    again = "make study NAME=stability RECORD=1, then docs/stability.md"
    assert [row[:4] for row in shown] == [row[:4] for row in found.rows], f"run: {again}"
    for before, now in zip(shown, found.rows, strict=True):
        assert before[5] == pytest.approx(now[5], rel=ROUNDING), f"{now}; run: {again}"
        pair = [float(row[4]) for row in (before, now)]
        assert max(pair) < UNSEEN or min(pair) >= (1 - SEARCHED) * max(pair), f"{now}; run: {again}"


def test_cases_that_differ_in_the_model_alone_are_one(monkeypatch) -> None:
    rows = [Row(*row, "b", "y", value, 1.0) for *row, value in (("x", "a", 0.5), ("z", "a", 0.5))]
    monkeypatch.setattr(
        study, "CASES", (lambda: iter([*rows, Row("x", "a", "b", "y", 0.25, 1.0)]),)
    )
    assert [row["model"] for row in study.rows()] == ["x, z", "x"]


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


def test_abs_that_wraps_says_no(monkeypatch) -> None:
    """Two's complement has no 8192 in 14 bits, so the magnitude becomes -8192."""

    def wrapping(self, data):
        half = 1 << (self.fmt.width - 1)
        return (np.abs(data) + half) % (2 * half) - half, data < 0

    monkeypatch.setattr(AbsUnit, "process", wrapping)
    rows = list(itertools.islice(activations.most_negative(), 4))
    assert [row.holds for row in rows] == [False, True, False, True]


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


@pytest.mark.parametrize(
    ("least", "figure"),
    [
        ("LEAST_ACC_WIDTH", "bits of the sum"),
        ("WHOLE_ACC_WIDTH", "bits of the sum, all nodes built"),
    ],
)
def test_an_accumulator_that_is_too_narrow_says_no(monkeypatch, least: str, figure: str) -> None:
    """Lean and whole engines take the width of their sums from the same place."""
    right = Graph.sum_bits
    monkeypatch.setattr(Graph, "sum_bits", lambda self, table: right(self, table) - 2)
    monkeypatch.setattr(engine, least, 0)
    assert ("deep engine", figure) in broken(layered.ends)


def _halves_up(right):
    def process(self, frames):
        return replace(self, program=replace(self.program, even=False)).compute(frames)

    return process


def test_frames_that_are_never_refused_say_no(monkeypatch) -> None:
    right = networks.InputController.process

    def lenient(self, last, clock):
        scan = right(self, last, clock)
        return replace(scan, done=np.asarray(last), error=np.zeros_like(scan.error))

    monkeypatch.setattr(networks.InputController, "process", lenient)
    assert broken(networks.readings) == {("frames", "decisions off")}


def test_an_accumulator_of_32_bits_says_no(monkeypatch) -> None:
    right = WeightedSum.sums
    monkeypatch.setattr(
        WeightedSum, "sums", lambda self, *a: right(self, *a).astype(np.int32).astype(np.int64)
    )
    models = {model for model, _ in broken(networks.accumulators)}
    assert models == {"input_integral", "neuron", "output_integral"}


def test_a_lost_sign_says_no(monkeypatch) -> None:
    monkeypatch.setattr(SignRetriever, "process", lambda self, mag, negative: np.asarray(mag))
    assert ("pade", "wrong signs") in broken(activations.divergence)
    assert ("gradient", "codes off") in broken(activations.most_negative)


def test_a_gate_that_is_left_out_says_no(monkeypatch) -> None:
    monkeypatch.setattr(ComparatorBank, "process", lambda self, mag: np.zeros_like(mag))
    assert ("pade", "codes off") in broken(activations.divergence)


def test_a_power_that_wraps_says_no(monkeypatch) -> None:
    def wrapping(self, exact, shift: int):
        return ((exact + ((1 << shift) >> 1)) >> shift) & ((1 << self.out_width) - 1)

    monkeypatch.setattr(PowerFold, "_rounded", wrapping)
    found = broken(visualisation.narrow_loads)
    assert {("power_fold", "error in LSB"), ("load_profile", "error in 2^-13")} <= found


def test_a_series_that_overflows_says_no(monkeypatch) -> None:
    """Hyperbolic functions that are not rescaled give NaN."""
    right = Plate.influence

    def overflowing(self, points, loads, terms: int = 1000):
        result = right(self, points, loads, terms)
        return result * np.nan if terms > 1000 else result

    monkeypatch.setattr(Plate, "influence", overflowing)
    assert ("plate", "error / w_max") in broken(physics.plates)


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


def test_a_step_that_is_too_long_says_no(monkeypatch) -> None:
    right = conditioned.Gradient.step

    def longer(self, lesson, kept, *rest):
        return kept + 5 * (right(self, lesson, kept, *rest) - kept)

    monkeypatch.setattr(conditioned.Gradient, "step", longer)
    assert ("board that learns", "codes") in broken(conditioned.learning)


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


def test_figures_that_are_not_finite_break_every_bound() -> None:
    assert largest(np.array([1.0, -3.0]), np.array(2.0)) == 3
    assert largest(np.array([1.0, np.nan])) == np.inf


def test_what_is_accepted_is_counted() -> None:
    assert accepted([lambda: Fix(1, 0), lambda: 1, lambda: 2]) == 2
    for fault, call in ((ZeroDivisionError, lambda: 1 / 0), (ValueError, lambda: int("x"))):
        with pytest.raises(fault):
            accepted([call])
