"""Tests that tables activations and iterations are complete, and what follows from them."""

import pytest

from golden.activation.pade import GATE, ITERATIONS, RHO
from golden.activation.reference import stable_below
from golden.activation.schemes import forms
from tactus.report.measure import activations
from tactus.report.measure.activation_errors import THESIS_FACTOR, measure
from tactus.report.measure.table import Table


def columns(table: Table, *names: str) -> list[tuple]:
    at = [table.columns.index(name) for name in names]
    return [tuple(row[c] for c in at) for row in table.rows]


@pytest.fixture(scope="module")
def schemes(measured_tables: dict[str, Table]) -> Table:
    return measured_tables["activations"]


@pytest.fixture(scope="module")
def steps(measured_tables: dict[str, Table]) -> Table:
    return measured_tables["iterations"]


def test_every_scheme_in_every_precision(schemes: Table) -> None:
    found = columns(schemes, "scheme", "arithmetic")
    assert len(set(found)) == len(found)
    for name, scheme in forms().items():
        assert {(name, precision.name) for precision in scheme.precisions} <= set(found)


def test_the_errors_are_those_of_make_activations(schemes: Table) -> None:
    known = {
        (f"{r.scheme}, {r.options}" if r.options else r.scheme, r.arithmetic): (
            r.mean_percent,
            r.largest,
        )
        for r in measure()
        if r.factor == THESIS_FACTOR or r.arithmetic == "exact"
    }
    names = ("scheme", "arithmetic", "mean %", "largest units")
    assert {(n, a): (mean, most) for n, a, mean, most in columns(schemes, *names)} == known


def test_clocks_of_hardware_and_of_nothing_else(schemes: Table) -> None:
    names = ("scheme", "arithmetic", "latency clocks", "interval clocks")
    for scheme, arithmetic, latency, interval in columns(schemes, *names):
        if arithmetic == "float":
            assert latency is interval is None
        else:
            assert latency >= interval if "pade" in scheme else interval == 1
            assert latency >= 1


def test_precise_and_bipartite_are_the_best_at_a_code_a_clock(schemes: Table) -> None:
    names = ("scheme", "mean %", "largest units", "interval clocks")
    rows = [row for row in columns(schemes, *names) if row[3] is not None]
    best = ("precise", "precise block_ram", "bipartite")
    ours = [row for row in rows if row[0] in best]
    others = [row for row in rows if row[0] not in best]
    assert len(ours) == len(best)
    assert max(row[1] for row in ours) < min(row[1] for row in others)
    assert max(row[2] for row in ours) < 1 < 4 < min(row[2] for row in others)


def test_every_rho_has_the_same_iterations(steps: Table) -> None:
    assert len(steps.rows) == 3 * len(activations.RHOS) * len(activations.ITERATIONS)
    names = ("rho", "iterations", "arithmetic")
    assert len(set(columns(steps, *names))) == len(steps.rows)


def test_a_rho_settles_where_it_is_stable_up_to_the_gate(steps: Table) -> None:
    names = ("rho", "stable below |q|", "iterations", "arithmetic", "mean %", "largest units")
    last = max(activations.ITERATIONS)
    for rho, stable, count, arithmetic, mean, largest in columns(steps, *names):
        assert stable == stable_below(rho)
        if count == last and stable > GATE:
            assert mean < 0.06
            assert arithmetic == "exact" or largest < 20
        elif count == last:
            assert mean > 2
            assert largest > 8000


def test_the_default_is_the_rho_that_settles_first_up_to_the_gate(steps: Table) -> None:
    """Only exact precision passes the gate here.

    With rho = 4.5, 24 iterations suffice, and 32 halve the mean error.
    """
    names = ("rho", "iterations", "arithmetic", "mean %", "largest units")
    rows = [row for row in columns(steps, *names) if row[2] == "exact"]
    needed = {rho: count for rho, count, _, _, largest in reversed(rows) if largest < 21.5}
    assert min(needed, key=lambda rho: (needed[rho], rho)) == RHO
    means = {count: mean for rho, count, _, mean, _ in rows if rho == RHO}
    assert means[ITERATIONS] < 0.6 * means[24]
    assert means[64] > 0.9 * means[ITERATIONS]


def test_a_small_rho_is_the_faster_where_it_settles(steps: Table) -> None:
    names = ("rho", "iterations", "arithmetic", "mean %")
    means = {(r, n): m for r, n, a, m in columns(steps, *names) if a == "float"}
    for count in (8, 16, 24):
        settling = [means[rho, count] for rho in activations.RHOS if rho >= 4]
        assert settling == sorted(settling)
