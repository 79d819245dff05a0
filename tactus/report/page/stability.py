"""The content of docs/stability.md and of its tables in docs/stability-cases.md."""

from golden.numbers.precision import SIGNAL
from tactus.report.measure.stability.digits import DIGITS
from tactus.report.measure.stability.margins import Case, cases, closest
from tactus.report.measure.stability.networks import USELESS
from tactus.report.measure.table import Table

CLOSEST = 5
# For each thing that must happen: a change that would make a figure exceed its bound.
BREAKS = {
    "refuse them": "a missing check of the arguments",
    "refuse it": "a missing check of the arguments",
    "stop at the rails": "a conversion that wraps, or that keeps codes beyond the format",
    "count them": "a conversion that clips without counting",
    "count what it clips": "a conversion that clips without counting",
    "refuse two, take the others": "a controller that does not count the samples of a frame",
    "equal exact integers": "an accumulator that is a bit too narrow, or a sum that wraps where it "
    "must saturate",
    "err by no more than rounding can cause": "a result that wraps, a lost sign, a format or "
    "a table that is a few bits too coarse",
    "refuse them: the sum would wrap": "accepting weights although a sum leaves its format",
    "keep inside its accumulator": "one bit less of the accumulator, or one weight more than it "
    "was built for",
    "give the largest code: saturate, not wrap": "an ABS that wraps: two's complement has no 8192 "
    "in 14 bits",
    "round as the quantiser says": "halves that are rounded up where they go to the even code",
    "be exact": "an ABS that inverts the bits and adds no 1",
    "give the negative of the largest code's result": "a lost sign, or an ABS that wraps",
    "give the largest code beyond the gate": "a missing gate: Pade's regression diverges there",
    "keep the sign": "a missing sign retriever",
    "stay in the format": "a regression that wraps before it is saturated",
    "stay in -1 to 1": "a missing gate",
    "diverge without saturation": "nothing in the hardware: it shows that the gate is needed",
    "keep the bound of every quotient": "a power or a table of exp with fewer fraction bits",
    "not exceed the load": "a profile that rounds up at its top",
    "saturate where t^6 does": "a power that wraps, or one that keeps fewer bits from step to step",
    "never fall": "a power that wraps",
    "equal exact integers, saturated": "a divider that does not stop at a width of 0",
    "be flat": "an exponential that does not reach 0",
    "be d at the centre, 0 beside it": "a power that overflows to NaN",
    "keep the bound of the terms left out": "hyperbolic functions that overflow to NaN",
    "not move": "a series whose terms do not vanish at the edge",
    f"agree with {DIGITS} digits": "a formula that subtracts large numbers, or rounds phases of "
    "many turns",
    "be infinite": "an inverse of a matrix that has none",
    "be in proportion to the noise": "squares of readings, in which those of their differences are "
    "lost",
    "give an outlook": "a covariance that rounding makes negative",
    "give the same in every unit": "a variance in fixed units, with which all centres coincide",
    "need more than 14 bits: there the pole would be 1": "nothing: it shows why the filter is "
    "analogue or in floating point",
    "have the slope of a side": "a slope of another segment than the value",
    "move away by no more than rounding": "a step that is too long for equations that are alike",
    "follow a reference of another family": "an integrator that stands still, overshoots, or has a "
    "looser tolerance",
    "follow the slow manifold": "an integrator that stands still, or a wrong ratio of weight and "
    "damping",
    "follow Jacobi's closed form": "a looser tolerance of the integrator",
    "pull no more than its energy allows": "an integrator that gains energy",
    "stay upright": "a looser tolerance: the smallest push grows by a factor of e each 1 / omega",
    "stay at rest": "an equation with a constant force in it",
    "keep its energy": "a looser tolerance, or more periods: the drift grows with their number",
}


def headline(table: Table) -> str:
    """A headline on how many cases hold, and for how many that says little."""
    found = cases(table)
    holding = sum(case.holds for case in found)
    exact = sum(case.part is None for case in found)
    reached = sum(case.reached for case in found)
    wide = _useless(found)
    worst = max(wide, key=lambda case: case.value)
    return (
        f"**{holding} of {len(found)} stiff, ill-conditioned and extreme cases keep their bound; "
        f"for {len(wide)} of them the bound is above 1 % of full scale, so that this says little."
        f"**\n\n"
        f"- {exact} cases count something that must never happen, such as a wrong code, an invalid "
        "argument that is accepted,\n  or a lost sign. Their bound is 0.\n"
        f"- {reached} cases reach their bound, and must: it is the largest code of a format, the "
        "bits that a sum was given, or\n  all the energy of a swing.\n"
        f"- The other {len(found) - exact - reached} keep a margin.\n"
        f"- Of those with wide bounds `{worst.label}` errs most: by {worst.value:,.0f} units of "
        f"2^-13, {100 * worst.value / 2**SIGNAL.frac:.2g} % of full scale."
    )


def _useless(found: list[Case]) -> list[Case]:
    """The cases whose bound is a large part of full scale, the widest first."""
    wide = [c for c in found if c.figure.startswith("error in 2^-13") and c.bound > USELESS]
    return sorted(wide, key=lambda one: -one.bound)


def nearest(table: Table) -> str:
    """The cases closest to their bound, one for each model and figure."""
    lines = [
        "| model | case | figure | measured | bound | margin |",
        "|---|---|---|---|---|---|",
    ]
    for case in closest(cases(table), CLOSEST):
        lines.append(_row(case.model, case.case, *_figures(case)))
    return "\n".join(lines)


def useless(table: Table) -> str:
    """The cases whose bound is a large part of full scale, with their error."""
    lines = ["| networks of | error, LSB | of full scale | bound, LSB | of full scale |"]
    lines.append(f"|{'---|' * 5}")
    for case in _useless(cases(table)):
        cells = [f"{case.label}, {case.case}"]
        for value in (case.value, case.bound):
            cells += [f"{value:,.0f}", f"{100 * value / 2**SIGNAL.frac:.2g} %"]
        lines.append(_row(*cells))
    return "\n".join(lines)


def kinds(table: Table) -> str:
    """What must happen, in how many cases, and what would break it."""
    found: dict[str, list[Case]] = {}
    for case in cases(table):
        found.setdefault(case.must, []).append(case)
    lines = ["| what must happen | model | cases | what would break it |", "|---|---|---|---|"]
    for must, alike in found.items():
        models = list(dict.fromkeys(name for case in alike for name in case.models))
        named = ", ".join(models) if len(models) <= 3 else f"{len(models)} models"
        lines.append(_row(must, named, str(len(alike)), BREAKS[must]))
    return "\n".join(lines)


def everything(table: Table) -> str:
    """Every case as measured."""
    lines = [
        "| model | case | must | figure | measured | bound | margin |",
        "|---|---|---|---|---|---|---|",
    ]
    for case in cases(table):
        lines.append(_row(case.model, case.case, case.must, *_figures(case)))
    return "\n".join(lines)


def _figures(case: Case) -> tuple[str, str, str, str]:
    return case.figure, f"{case.value:.4g}", f"{case.bound:.4g}", margin(case)


def margin(case: Case) -> str:
    """How many times as large as the figure its bound is."""
    if case.part is None:
        return "must be 0"
    if case.reached:
        return "reached"
    if case.part < 1e-3:
        return "over 1000 times"
    return f"{1 / case.part:.3g} times"


def _row(*cells: str) -> str:
    # A vertical bar would end the cell.
    return f"| {' | '.join(cell.replace('|', '&#124;') for cell in cells)} |"
