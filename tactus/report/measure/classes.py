"""The tables on the decisions of a scene with classes."""

import numpy as np

from tactus.errors import held_out_or_all
from tactus.report.measure.outcome import Outcome
from tactus.report.measure.table import Cell, Table

# So many rows are shown that are decided wrongly, those with the largest margins.
WORST = 20


def accuracy(found: Outcome) -> Table:
    """The part of the rows that is decided rightly, on all rows and on those held out."""
    every = found.decisions
    kinds = {"all rows": every}
    if found.held_out is not None:
        kinds["held-out rows"] = every.take(found.held_out)
    rows: list[list[Cell]] = []
    for name, some in kinds.items():
        count = len(some.actual)
        parts = [100 * n / count for n in (some.right, some.right_real)]
        rows.append([name, count, *parts, some.differ])
    return Table(
        "accuracy",
        ["rows", "number", "right %", "right in floating point %", "decided differently"],
        rows,
        "The decision is the class of the largest output, the first one of equal outputs. 'Right' "
        "is bit-true, as the hardware decides. The last column has the number of rows that "
        "hardware and floating point decide differently.",
    )


def per_class(found: Outcome) -> Table:
    """How many rows of each class are decided rightly, and how often each decision is right."""
    some, which = held_out_or_all(found.scene, found.decisions)
    counts = some.confusion
    rows: list[list[Cell]] = []
    for n, label in enumerate(some.labels):
        right, there, said = int(counts[n, n]), int(counts[n].sum()), int(counts[:, n].sum())
        parts: list[Cell] = [100 * right / of if of else None for of in (there, said)]
        others = counts[n].copy()
        others[n] = 0
        taken = some.labels[int(others.argmax())] if others.any() else ""
        rows.append([label, there, right, parts[0], said, parts[1], taken])
    return Table(
        "per_class",
        ["class", "rows", "right", "right %", "decided", "of these right %", "else mostly"],
        rows,
        f"Bit-true decisions on {which}. 'Decided' is the number of rows of which the hardware "
        "says that they are of the class.",
    )


def wrong_rows(found: Outcome) -> Table:
    """The rows that are decided wrongly, those of the largest margin first."""
    some = found.decisions
    wrong = np.flatnonzero(some.bit_true != some.actual)
    held = set() if found.held_out is None else set(found.held_out.tolist())
    rows: list[list[Cell]] = []
    for row in wrong[np.argsort(-some.margins[wrong], kind="stable")][:WORST]:
        labels = (some.labels[some.actual[row]], some.labels[some.bit_true[row]])
        real = some.labels[some.real[row]]
        seen = "held out" if int(row) in held else ""
        rows.append([int(found.numbers[row]), *labels, real, int(some.margins[row]), seen])
    files = " and of ".join(path.name for path in found.scene.data_paths)
    return Table(
        "wrong_rows",
        ["row", "recorded", "decided", "in floating point", "margin", ""],
        rows,
        f"{len(wrong)} of {len(some.actual)} rows are decided wrongly; those with the largest "
        f"margins, {WORST} at most. The margin is the difference of the two largest outputs in "
        f"codes. Row 1 of {files} is the first below its header.",
    )
