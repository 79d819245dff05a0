"""Tests every activation that a scene can name, over every code that it can get."""

import json
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from golden.activation.bipartite import Bipartite
from golden.activation.bipartite_table import FORMATS
from golden.activation.pade import fraction, pade_real
from golden.activation.precise import Precise
from golden.activation.reference import (
    inverse,
    inverse_fraction,
    pade_fraction,
    rho_regression,
    taylor,
)
from golden.activation.schemes import SCHEMES, forms
from golden.engine.formats import DROPPED, HIDDEN, RESULT
from golden.engine.tanh_table import tanh_table
from golden.input_error import InputError
from golden.networks.left_out import parts_left_out
from golden.numbers.fixed import Codes, Fix
from golden.numbers.precision import EXACT, SIGNAL, THESIS
from golden.numbers.transcendental import tanh_floors
from tactus.report.activations import plot_file
from tactus.report.measure.activation_errors import FACTORS
from tactus.report.measure.table import Table, read_csv

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


def test_the_thesis_is_right_about_series_and_fraction() -> None:
    """The series is off by up to 2.3 % of tanh for positive q, the fraction by less than 0.25 %."""
    positive = Q[Q > 0]
    worst = np.abs(taylor(positive) / np.tanh(positive) - 1).max()
    assert 100 * worst == pytest.approx(2.3, abs=0.05)
    assert 100 * np.abs(pade_fraction(Q) - np.tanh(Q)).max() < 0.25
    assert pade_fraction(1e-8) == pytest.approx(1e-8)


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


def rows_of(table: Table, **wanted: str) -> list[dict]:
    rows = (dict(zip(table.columns, row, strict=True)) for row in table.rows)
    return [row for row in rows if wanted.items() <= row.items()]


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


FMT = EXACT.hidden_fmt
EVERY = np.arange(FMT.low, FMT.high + 1)
# The number of codes that are not the correctly rounded tanh, and the largest error in units of
# 2**-13 below the largest code.
ROUNDED = {"precise": (12770, 0.957), "precise block_ram": (452, 0.519)}


def build(name: str, reach: int = FMT.high) -> Precise:
    block = forms()[name].build(EXACT, 1, reach)
    assert isinstance(block, Precise)
    return block


def tanh_units() -> np.ndarray:
    """tanh of every code in units of 2**-13, with an error of less than 2**-38 of a unit."""
    return np.tanh(FMT.to_real(EVERY)) * 8192


@pytest.mark.parametrize("name", ROUNDED)
def test_how_many_codes_are_not_rounded_correctly(name: str) -> None:
    """For larger q, tanh lies between the largest code and 1, so the error is up to a unit."""
    exact, results = tanh_units(), build(name).process(EVERY)
    nearest = np.minimum(np.floor(np.abs(exact) + 0.5), SIGNAL.high) * np.sign(exact)
    # No tanh is so near to half a unit that its last bits could change which code is the nearest.
    assert np.abs(np.abs(exact) % 1 - 0.5).min() > 2**-34
    wrong, largest = ROUNDED[name]
    assert int((results != nearest).sum()) == wrong
    error = np.abs(results - exact)[np.abs(results) < SIGNAL.high].max()
    assert error == pytest.approx(largest, abs=5e-4)
    assert (np.diff(results) >= 0).all()


# How many codes are not the nearest to tanh, and the largest error in units of 2**-13.
TRUNCATED = {"block_ram": (23416, 0.708), "logic": (90322, 4.497)}


def built(memory: str, reach: int = FMT.high) -> Bipartite:
    block = SCHEMES["bipartite"].configured({"memory": memory}).build(EXACT, 1, reach)
    assert isinstance(block, Bipartite)
    return block


def middle_units() -> np.ndarray:
    """tanh of the middle of every step, in codes of r, with an error below 2**-37 of a code."""
    return np.tanh((EVERY + 0.5) * 2.0**-14) * 16384


@pytest.mark.parametrize("memory", FORMATS)
def test_error_and_wrong_codes_are_those_of_the_page(memory: str) -> None:
    results = built(memory).process(EVERY)
    exact = middle_units()
    # No tanh is so near to a whole code that its last bits could change which code is the nearest.
    assert np.abs(exact - np.rint(exact)).min() > 2**-34
    wrong, bound = TRUNCATED[memory]
    assert int((results != np.floor(exact)).sum()) == wrong
    assert bound - 0.001 < np.abs(results + 0.5 - exact).max() / 2 < bound
    assert (np.diff(results) >= 0).all()


@pytest.mark.parametrize("memory", FORMATS)
@pytest.mark.parametrize("width", [16, 18, 20])
def test_a_wider_q_saturates_and_a_narrower_one_is_the_same(memory: str, width: int) -> None:
    whole = built(memory)
    other = whole.taking(width)
    fmt = Fix(width, FMT.frac)
    codes = np.arange(fmt.low, fmt.high + 1)
    assert other.in_fmt == fmt
    assert np.array_equal(other.process(codes), whole.process(np.clip(codes, FMT.low, FMT.high)))


WIDTHS = (7, 8, 9)
HIDDEN_CODES = np.arange(HIDDEN.low, HIDDEN.high + 1)
# The number of fraction bits of the reference.
FRAC = 40


def table_results(width: int) -> Codes:
    """tanh of every code from intercept and slope of its segment, exact and then rounded once."""
    table = tanh_table(width)
    segment = np.minimum(
        np.where(HIDDEN_CODES < 0, ~HIDDEN_CODES, HIDDEN_CODES) >> width, len(table.slopes) - 1
    )
    middle = np.where(HIDDEN_CODES < 0, -1, 1) * np.array(table.intercepts)[segment]
    distance = (HIDDEN_CODES & ((1 << width) - 1)) - (1 << (width - 1))
    total = (middle << DROPPED) + np.array(table.slopes)[segment] * distance
    return np.clip((total + (1 << (DROPPED - 1))) >> DROPPED, RESULT.low, RESULT.high)


@pytest.fixture(scope="module")
def floors() -> Codes:
    """The floor of tanh 2**FRAC for every code from 0 on, and for one more."""
    return tanh_floors(Fraction(1, 1 << HIDDEN.frac), len(HIDDEN_CODES) // 2 + 1, FRAC)


def table_errors(width: int, floors: Codes) -> Codes:
    """The distance of each result from tanh, in codes of FRAC fraction bits, to within one code."""
    exact = np.where(HIDDEN_CODES < 0, -floors[np.abs(HIDDEN_CODES)], floors[np.abs(HIDDEN_CODES)])
    return np.abs((table_results(width) << (FRAC - RESULT.frac)) - exact)


@pytest.mark.parametrize("width", WIDTHS)
def test_a_table_is_within_one_unit_of_a_signal_monotone_and_odd(width: int, floors: Codes) -> None:
    found = table_results(width)
    assert table_errors(width, floors).max() < 1 << (FRAC - SIGNAL.frac)
    assert (np.diff(found) >= 0).all()
    assert np.array_equal(found[1:], -found[:0:-1])


@pytest.mark.parametrize("width", [6, 10])
def test_another_width_is_refused(width: int) -> None:
    with pytest.raises(InputError, match=f"segment_width: got {width}, expected one of 7, 8, 9"):
        tanh_table(width)
