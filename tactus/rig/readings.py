"""Finds out what recorded readings show before anything is trained on them.

Each function checks one thing and returns its findings, which are often none.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from golden.numbers.precision import SIGNAL
from golden.numbers.real import Real
from tactus.core.finding import FAULT, NOTE, WARNING, Finding, several

# A network has some dozens of weights, and only half of the rows train.
LEAST_ROWS, FEW_ROWS = 8, 50
# A sensor that uses a smaller part of the codes is measured in steps of more than one per cent.
FEW_CODES = 100
# So many equal readings at an end, and so many times as often as any reading within, are no chance.
AT_AN_END, TIMES_WITHIN = 3, 3
# Columns that differ by more than this part of their range carry different information.
ALIKE = 1e-3
# If a larger part of a recording lies on straight lines, it was interpolated, or read far too
# densely.
LINES = 0.05
# A column with at most so many whole numbers, each in this many rows or more on average, may hold
# labels.
MOST_NUMBERS, ROWS_EACH = 12, 5


def few_rows(subject: str, rows: int) -> list[Finding]:
    """Find too few rows for a split, or for reliable results."""
    if rows < LEAST_ROWS:
        text = f"got {rows} rows, expected at least {LEAST_ROWS} to split in 50, 25, 25 %"
        return [Finding(FAULT, subject, text)]
    if rows < FEW_ROWS:
        text = (
            f"{rows} rows: {rows // 2} train, {rows // 4} choose; what comes out depends on which"
        )
        return [Finding(WARNING, subject, text)]
    return []


def constant(values: Real) -> bool:
    return bool((values == values[0]).all())


def counts_rows(values: Real) -> bool:
    """Whether a column rises by the same step from row to row, as a row number or a time does."""
    steps = np.diff(values)
    # Equal steps differ by last decimals of a file and by last bits of the values, which are 2e-7
    # for seconds since 1970.
    same = 1e-6 * np.abs(steps[:1]) + 4 * np.spacing(np.abs(values).max())
    return len(steps) > 1 and steps[0] != 0 and bool((np.abs(steps - steps[0]) <= same).all())


def repeats(values: Real, other: Real) -> bool:
    """Whether a column equals another one, apart from a factor and an offset between units."""
    if constant(values) or constant(other):
        return False
    a, b = (np.asarray(v - v.mean()) / np.ptp(v) for v in (values, other))
    sign = 1 if (a * b).sum() > 0 else -1
    # Each column is rounded to its decimals, and so are its ends and its mean.
    rounded = sum(1.5 * 10.0 ** -_decimals(v) / np.ptp(v) for v in (values, other))
    return bool(np.abs(a - sign * b).max() <= min(rounded, ALIKE) + 1e-9)


def at_ends(columns: Mapping[str, Real], known: Sequence[float] = ()) -> list[Finding]:
    """Find many equal readings at an end of the range, where a converter or amplifier saturates.

    Sensors that end at the same reading are in one finding.

    columns: The readings of each sensor.
    known: Readings that a scene has named in ``data.ends``; nothing is found there.
    """
    ending: dict[tuple[float, str], dict[str, int]] = {}
    for name, values in columns.items():
        found, counts = np.unique(values, return_counts=True)
        if len(found) < 2 * TIMES_WITHIN:
            continue
        least = max(AT_AN_END, TIMES_WITHIN * counts[1:-1].max() + 1)
        for place, which in ((0, "least"), (-1, "largest")):
            if counts[place] >= least and found[place] not in known:
                there = ending.setdefault((float(found[place]), which), {})
                there[name] = int(counts[place])
    return [_at_end(end, which, counts) for (end, which), counts in ending.items()]


def _at_end(end: float, which: str, counts: Mapping[str, int]) -> Finding:
    least, most = min(counts.values()), max(counts.values())
    span = f"{least}" if least == most else f"{least} to {most}"
    its, each = ("its", "") if len(counts) == 1 else ("their", " of each")
    text = (
        f"{span} readings{each} are exactly {end:g}, {its} {which}: does {its} range end there? "
        f"data.ends = [{end:g}] says that such readings are right"
    )
    return Finding(WARNING, several([*counts]) if len(counts) > 1 else next(iter(counts)), text)


def beyond(name: str, values: Real) -> int:
    """The number of readings beyond the range of the hardware's codes."""
    return SIGNAL.quantise(values, name)[1]


def few_codes(name: str, values: Real) -> list[Finding]:
    codes = np.ptp(values) * 2**SIGNAL.frac
    if codes >= FEW_CODES:
        return []
    text = (
        f"moves over {codes:.0f} of the {2**SIGNAL.width} codes from -1 to 1; give it a scale "
        "(data.scale), or amplify it"
    )
    return [Finding(WARNING, name, text)]


def on_lines(readings: Real) -> NDArray[np.intp]:
    """Rows in which most sensors equal, to their last decimal, the means of the neighbouring rows.

    A sensor does not count if its reading is the same as in the row before.
    """
    if len(readings) < 3:
        return np.zeros(0, dtype=np.intp)
    before, here, after = readings[:-2], readings[1:-1], readings[2:]
    # A mean needs one decimal more than is written, so it was rounded.
    slack = 0.5 * 10.0 ** -np.array([_decimals(column) for column in readings.T])
    slack = slack * (1 + 1e-6) + 1e-12 * np.abs(readings).max(axis=0)
    straight = (np.abs(here - (before + after) / 2) <= slack) & (here != before)
    return np.flatnonzero(2 * straight.sum(axis=1) > readings.shape[1]) + 1


def interpolated(subject: str, readings: Real) -> list[Finding]:
    """Find interpolated rows, which add nothing; held-out rows among them have been seen."""
    lines = len(on_lines(readings))
    if lines <= LINES * len(readings):
        return []
    text = (
        f"{lines} of {len(readings)} rows are exact means of the rows beside them, in most "
        "sensors: interpolated, or read very densely; a random row that is held out has been seen"
    )
    return [Finding(WARNING, subject, text)]


def twins(subject: str, names: Sequence[str], readings: Real) -> list[Finding]:
    found = []
    for c, name in enumerate(names):
        for other in range(c):
            if repeats(readings[:, c], readings[:, other]):
                text = f"{name!r} repeats {names[other]!r}, perhaps in another unit"
                found.append(Finding(WARNING, subject, text))
                break
    return found


def perhaps_labels(name: str, values: Real) -> list[Finding]:
    numbers = np.unique(values)
    few = 2 < len(numbers) <= MOST_NUMBERS and ROWS_EACH * len(numbers) <= len(values)
    if not few or not np.array_equal(numbers, numbers.round()):
        return []
    text = (
        f"holds only the whole numbers {numbers[0]:g} to {numbers[-1]:g}; if they are names of "
        f"classes and no quantity, CLASSES={name} writes a scene that tells these apart"
    )
    return [Finding(NOTE, name, text)]


def step(column: Real) -> float:
    """The smallest difference between two values of a column, as they are written."""
    return float(10.0 ** -_decimals(column))


def _decimals(column: Real) -> int:
    """The number of decimals that hold every value of a column."""
    return next((d for d in range(13) if np.array_equal(column.round(d), column)), 13)
