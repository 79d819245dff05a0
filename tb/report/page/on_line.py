"""The content of docs/learning.md: the tables ``on_line_learning`` and ``beyond_drift``."""

from tb.report.draw.findings import Row, number, rows_of
from tb.report.draw.plots import Plot, side_by_side
from tb.report.measure.on_line_learning import (
    CLOCK,
    COMPUTER,
    COUNTS,
    KACZMARZ,
    LMS,
    NOISES,
    NONE,
    RECURSIVE,
    RULES,
)
from tb.report.measure.table import Table

OUTPUTS = ("load", "position", "width", "shape")
MOST = max(COUNTS)
# The noise of the ranges, in millivolts.
NOISY = 1e3 * max(NOISES)
# The lines of the picture: a label, and the rule with its passes.
DRAWN = {
    "no correction": (NONE, None),
    "make recalibrate": (COMPUTER, None),
    "Kaczmarz, kept": (KACZMARZ, 100),
    "Kaczmarz, once": (KACZMARZ, 1),
    "least squares, once": (RECURSIVE, 1),
    "least squares, kept": (RECURSIVE, 3),
    "conjugate gradients, kept": ("conjugate gradients, 36 bits", 3),
    "perturbation, kept": ("perturbation (SPSA)", 2000),
    "LMS, constant step, kept": (LMS, 400),
    "output layers, once": ("output layers, recursive least squares", 1),
}


def errors(table: Table) -> str:
    """What every rule leaves of a drift after the most placements, without noise and with it."""
    heads = ["rule", "passes", *(f"{1e3 * noise:g} mV" for noise in NOISES), "times"]
    lines = [_line(heads), f"|{'---|' * len(heads)}"]
    for name, passes in [(NONE, None), (COMPUTER, None), *((r.name, r.passes) for r in RULES)]:
        rows = rows_of(table, rule=name, passes=passes, placements=MOST)
        times = max(number(row, "times") for row in rows)
        cells = [name, str(passes or ""), *map(_medians, rows)]
        lines.append(_line([*cells, f"{times:.2f}"]))
    return "\n".join(lines)


def costs(table: Table) -> str:
    """What every rule takes for the most placements, and what does not fit."""
    heads = ["rule", "passes", "steps", "clocks", "ms", "words", "LUTs", "bits", "does not fit"]
    lines = [_line(heads), f"|{'---|' * len(heads)}"]
    for rule in RULES:
        rows = rows_of(table, rule=rule.name, passes=rule.passes, placements=MOST)
        # Without noise the equations count most.
        row = rows[0]
        clocks = number(row, "clocks")
        cells = [
            rule.name,
            str(rule.passes),
            str(row["steps"]),
            f"{clocks:,.0f}",
            f"{1e3 * clocks / CLOCK:.3g}",
            str(row["words"]),
            str(row["LUTs"]),
            str(row["sum bits"]),
            str(row["does not fit"]),
        ]
        lines.append(_line(cells))
    return "\n".join(lines)


def by_placements(table: Table) -> str:
    """The errors of the best rules for few and many placements, with their ranges."""
    heads = ["placements", "rule", *(f"{name}, %" for name in OUTPUTS)]
    lines = [_line(heads), f"|{'---|' * len(heads)}"]
    best = {
        "`make recalibrate`": (COMPUTER, None),
        "least squares, kept": (RECURSIVE, 3),
        "least squares, once": (RECURSIVE, 1),
        "LMS, constant step, kept": (LMS, 400),
    }
    for count in COUNTS:
        for label, (name, passes) in best.items():
            row = _row(table, name, passes, count, NOISY)
            lines.append(_line([str(count), label, *_with_ranges(row)]))
    return "\n".join(lines)


def beyond(table: Table) -> str:
    """The errors after each change that is no drift, with their ranges."""
    heads = ["change", "correction", *(f"{name}, %" for name in OUTPUTS)]
    lines = [_line(heads), f"|{'---|' * len(heads)}"]
    for row in rows_of(table):
        lines.append(_line([str(row["change"]), str(row["correction"]), *_with_ranges(row)]))
    return "\n".join(lines)


def _with_ranges(row: Row) -> list[str]:
    return [
        f"{number(row, f'{output} %'):.2f} ({number(row, f'{output} from %'):.2f} to "
        f"{number(row, f'{output} to %'):.2f})"
        for output in OUTPUTS
    ]


def picture(table: Table) -> str:
    """The mean over the outputs of what is left, against the placements that were shown."""
    quiet, noisy = (_plot(table, 1e3 * noise) for noise in (min(NOISES), max(NOISES)))
    title = "Error that is left of a drift against placements that were shown, for each rule"
    return side_by_side("on_line_learning", title, [quiet, noisy]) + "\n"


def _plot(table: Table, millivolts: float) -> Plot:
    groups = {
        label: [(count, _mean(_row(table, name, passes, count, millivolts))) for count in COUNTS]
        for label, (name, passes) in DRAWN.items()
    }
    last = ", ".join(f"{label} {points[-1][1]:.2f} %" for label, points in groups.items())
    return Plot(
        f"on_line_learning_{millivolts:g}",
        f"Read with a noise of {millivolts:g} mV",
        "placements that were shown",
        "worst error, mean of the outputs, %",
        groups,
        f"After {MOST} placements: {last}.",
        ["on_line_learning"],
        linear="x",
    )


def _row(table: Table, name: str, passes: int | None, count: int, millivolts: float) -> Row:
    (row,) = rows_of(table, rule=name, passes=passes, placements=count, noise_mV=millivolts)
    return row


def _mean(row: Row) -> float:
    return sum(number(row, f"{output} %") for output in OUTPUTS) / len(OUTPUTS)


def _medians(row: Row) -> str:
    return ", ".join(f"{number(row, f'{output} %'):.2f}" for output in OUTPUTS)


def _line(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"
