"""Tests every activation that a scene can name, over every code that it can get."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from golden.activation.pade import fraction, pade_real
from golden.activation.reference import (
    inverse,
    inverse_fraction,
    pade_fraction,
    rho_regression,
    stable_below,
    taylor,
)
from golden.activation.schemes import forms
from golden.input_error import InputError
from golden.networks.left_out import parts_left_out
from golden.numbers.precision import SIGNAL, THESIS
from tactus.report.activations import plot_file
from tactus.report.measure import activation_errors as errors
from tactus.report.measure.activation_errors import FACTORS
from tactus.report.measure.table import Table, read_csv, rows_of

FORMS = forms()
# The largest error against tanh, and against the scheme in real arithmetic, in units of 2**-13.
# What does not approximate tanh needs no entry if it only rounds.
BOUNDS = {
    "gradient": (134, 2.5),
    "gradient_parallel": (134, 2.5),
    "lut": (224, 1.5),
    "pade": (21.5, 13),
    "polynomial": (156, 24),
    "bipartite": (0.708, 0.708),
    "bipartite logic": (4.497, 4.497),
    "precise": (0.999, 0.999),
    "precise block_ram": (0.999, 0.999),
}
BUILDS = [(name, precision) for name in FORMS for precision in FORMS[name].precisions]
BUILD_IDS = [f"{name}-{precision.name}" for name, precision in BUILDS]
OF_TANH = [(name, precision) for name, precision in BUILDS if FORMS[name].of_tanh]
OF_TANH_IDS = [f"{name}-{precision.name}" for name, precision in OF_TANH]
CASES = [
    (name, precision, factor)
    for name, precision in BUILDS
    for factor in ((1, 2, 3, 8, 77, 512) if precision.normalise else (1,))
]
IDS = [f"{name}-{p.name}-q{q}" for name, p, q in CASES]


def every_code(precision):
    return np.arange(precision.hidden_fmt.low, precision.hidden_fmt.high + 1)


def test_every_form_has_its_bounds() -> None:
    assert {name for name, _ in OF_TANH} <= set(BOUNDS) <= set(FORMS)


@pytest.mark.parametrize(("name", "precision", "factor"), CASES, ids=IDS)
def test_error_over_every_code(name: str, precision, factor: int) -> None:
    block = FORMS[name].build(precision, factor, precision.hidden_fmt.high)
    codes = every_code(precision)
    q = factor * block.real_input(codes)
    results = block.real_result(block.process(codes))
    value, slope = FORMS[name].real(q.reshape(2, -1))
    assert value.shape == slope.shape == (2, len(q) // 2)
    scheme = np.clip(value.ravel(), -1, block.real_result(block.out_fmt.high))
    # The most negative code saturates, and the sign of the result at 0 may differ.
    inner = (codes > codes[0]) & (codes != 0)
    of_tanh, rounding = BOUNDS.get(name, (0, 1))
    assert 8192 * np.abs(results - scheme)[inner].max() <= rounding
    if FORMS[name].of_tanh:
        assert 8192 * np.abs(results - np.tanh(q)).max() <= of_tanh


@pytest.mark.parametrize(("name", "precision", "factor"), CASES, ids=IDS)
def test_odd_and_inside_the_format(name: str, precision, factor: int) -> None:
    block = FORMS[name].build(precision, factor, precision.hidden_fmt.high)
    codes = every_code(precision)
    results = block.process(codes)
    assert np.array_equal(results.reshape(2, -1), block.compute(codes.reshape(2, -1)))
    if block.half_codes:
        assert np.array_equal(results, ~block.process(~codes))
        return
    assert block.out_fmt == SIGNAL
    assert SIGNAL.low <= results.min() <= results.max() <= SIGNAL.high
    if not FORMS[name].of_tanh:
        return
    assert results.min() > SIGNAL.low
    positive = codes[codes > 0]
    assert np.array_equal(block.process(-positive), -block.process(positive))
    assert block.process(codes[0]) == -block.process(codes[-1])


@pytest.mark.parametrize(("name", "precision"), OF_TANH, ids=OF_TANH_IDS)
@pytest.mark.parametrize("reach", [0.01, 0.3, 1.2, 1.9, 3.0])
def test_what_is_out_of_reach_is_left_out_and_changes_nothing(name, precision, reach) -> None:
    factor = 5 if precision.normalise else 1
    limit = int(reach / factor * 2**precision.hidden_fmt.frac)
    full = FORMS[name].build(precision, factor, precision.hidden_fmt.high)
    lean = FORMS[name].build(precision, factor, limit)
    assert parts_left_out(lean).total() > parts_left_out(full).total() == 0
    codes = np.arange(-limit, limit + 1)
    assert np.array_equal(lean.process(codes), full.process(codes))


@pytest.mark.parametrize("name", FORMS)
def test_slope_of_the_real_scheme_is_its_rise(name: str) -> None:
    """Slopes are compared away from borders, over a distance longer than the steps of a table."""
    q = np.linspace(-5, 5, 997)
    step = 3.5 / 128 / 2
    value = FORMS[name].real
    rise = (value(q + step)[0] - value(q - step)[0]) / (2 * step)
    slope = value(q)[1]
    assert np.median(np.abs(slope - rise)) < 0.03
    if FORMS[name].of_tanh:
        assert np.abs(slope - (1 - np.tanh(q) ** 2)).max() < 0.35


@pytest.mark.parametrize(("name", "precision"), BUILDS, ids=BUILD_IDS)
def test_a_code_outside_the_format_is_refused(name: str, precision) -> None:
    fmt = precision.hidden_fmt
    block = FORMS[name].build(precision, 3 if precision.normalise else 1, fmt.high)
    with pytest.raises(InputError, match=f"{block.block} data: got code {fmt.high + 1} at index"):
        block.process([0, fmt.high + 1])


@pytest.mark.parametrize("name", [name for name in FORMS if THESIS in FORMS[name].precisions])
def test_too_large_a_factor_names_it_and_the_format(name: str) -> None:
    with pytest.raises(InputError, match=r"Q = 200000.*Fix\(14,1?\d\)"):
        FORMS[name].build(THESIS, 200_000, SIGNAL.high)


Q = np.linspace(-3, 3, 601)


def test_taylor_is_the_cut_series() -> None:
    power = 1 + 2 * Q + 4 * Q**2 / 2 + 8 * Q**3 / 6 + 16 * Q**4 / 24
    assert taylor(Q) == pytest.approx((power - 1) / (power + 1))


def test_the_thesis_is_right_about_series_and_fraction() -> None:
    """The series is off by up to 2.3 % of tanh for positive q, the fraction by less than 0.25 %."""
    positive = Q[Q > 0]
    worst = np.abs(taylor(positive) / np.tanh(positive) - 1).max()
    assert 100 * worst == pytest.approx(2.3, abs=0.05)
    assert 100 * np.abs(pade_fraction(Q) - np.tanh(Q)).max() < 0.25
    assert pade_fraction(1e-8) == pytest.approx(1e-8)


@pytest.mark.parametrize(
    ("rho", "limit"), [(1, 1.447), (2, 2.371), (3, 2.933), (4, 3.352), (5, 3.691)]
)
def test_stability_limits_of_rho(rho: float, limit: float) -> None:
    assert stable_below(rho) == pytest.approx(limit, abs=5e-4)
    for q, settles in ((0.999 * limit, True), (1.001 * limit, False)):
        missing = abs(rho_regression(q, rho, 8000) - pade_fraction(q))
        assert missing < 1e-3 if settles else missing > 10


def test_a_rho_that_never_settles_is_refused() -> None:
    with pytest.raises(InputError, match=r"rho: got 0.5, expected above 0.5"):
        stable_below(0.5)


def test_the_regression_step_by_step_is_its_closed_form() -> None:
    for rho, iterations in ((4.0, 1), (4.0, 24), (4.5, 32)):
        expected = np.clip(np.abs(rho_regression(Q, rho, iterations)), 0, 1) * np.sign(Q)
        assert pade_real(Q, rho, iterations)[0] == pytest.approx(expected)


def test_the_inverse_regression_settles_below_2_888_and_its_inversion_below_1_915() -> None:
    a, b = fraction(Q)
    inside = np.abs(Q) < 2.87
    assert inverse_fraction(Q, 4000)[inside] == pytest.approx((b / a)[inside])
    assert abs(inverse_fraction(2.89, 4000)) > 1e3
    z = np.array([0.1, 0.9, 1.5, 1.99])
    assert inverse(z, 4000) == pytest.approx(1 / z)
    for q, settles in ((1.90, True), (1.93, False)):
        h = inverse_fraction(q, 400)
        assert h == pytest.approx(q / np.tanh(q), rel=1e-4)
        assert (abs(q * inverse(h, 4000) - np.tanh(q)) < 1e-3) == settles


ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the command writes, and prints."""
    build = tmp_path_factory.mktemp("build")
    result = subprocess.run(
        [sys.executable, "-m", "tactus.report.activations", "--build", str(build)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    assert not result.stderr
    (build / "printed").write_text(result.stdout)
    return build


@pytest.fixture(scope="module")
def table(folder: Path) -> Table:
    written = json.loads((folder / "activations" / "errors.json").read_text())
    assert set(written.pop("versions")) == {"python", "numpy", "matplotlib"}
    return Table("activation_errors", **written)


def test_every_form_is_measured_in_all_its_precisions(table: Table) -> None:
    for name, scheme in forms().items():
        for row in rows_of(table, scheme=name):
            filled = {factor for factor in FACTORS if row[f"Q = {factor}"] is not None}
            assert filled == ({1} if row["arithmetic"] == "exact" else set(FACTORS))
        found = [row["arithmetic"] for row in rows_of(table, scheme=name)]
        normalised = any(precision.normalise for precision in scheme.precisions)
        assert sorted(found) == sorted(
            [precision.name for precision in scheme.precisions] + ["float"] * normalised
        )


def test_which_reading_of_equation_4_32_is_the_thesis(table: Table) -> None:
    """For every scheme of piecewise curves, twice equation 4.32 is nearer to the printed figure."""
    for name in ("gradient", "gradient_parallel", "polynomial", "lut"):
        (row,) = rows_of(table, scheme=name, arithmetic="float")
        assert abs(row["x 2 %"] - row["thesis %"]) < 0.2 * row["thesis %"]
        assert abs(row["mean %"] - row["thesis %"]) > 0.45 * row["thesis %"]
    (row,) = rows_of(table, scheme="pade, as thesis", arithmetic="thesis")
    assert row["mean %"] < row["x 2 %"] < row["thesis %"] == 0.09


def test_the_command_prints_and_draws_what_it_measures(folder: Path, table: Table) -> None:
    assert (folder / "printed").read_text().startswith("\n".join(table.lines()))
    columns, written = read_csv(folder / "activations" / "errors.csv")
    assert columns == table.columns
    assert [row[-1] for row in written] == [row[-1] for row in table.rows]
    plots = {path.name for path in (folder / "activations").glob("*.svg")}
    assert plots == set(map(plot_file, forms()))


def test_a_scheme_of_our_own_has_no_figure_of_the_thesis() -> None:
    assert errors.thesis_figure("gradient_parallel") == 0.40
    assert errors.thesis_figure("relu") is None
