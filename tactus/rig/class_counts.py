"""Finds what the numbers of rows of each class spoil, before anything is trained on them."""

import numpy as np

from golden.numbers.real import Real
from tactus.core.finding import FAULT, NOTE, OK, WARNING, Finding, several
from tactus.scene import Scene
from tactus.scene.vectors import read_recorded
from tactus.train.descent.split import split_of

# With more rows in the largest class than so many times those in the smallest, a network may name
# the largest too often.
UNEQUAL = 3
# A column with at most so many whole numbers, each in this many rows or more on average, may hold
# labels.
MOST_NUMBERS, ROWS_EACH = 12, 5


def findings(scene: Scene) -> list[Finding]:
    """What is found in the classes of a scene; nothing if its outputs are numbers."""
    if not scene.labels:
        return []
    wanted, split = read_recorded(scene).targets, split_of(scene)
    parts = (wanted, *(wanted[rows] for rows in (split.training, split.test)))
    rows, trains, held = (part.sum(axis=0).astype(int) for part in parts)
    counts = ", ".join(f"{n} of {label!r}" for n, label in zip(rows, scene.labels, strict=True))
    subject = f"data.classes {scene.classes}"
    found = [Finding(OK, subject, f"rows: {counts}")]
    none_trains = [label for label, n in zip(scene.labels, trains, strict=True) if not n]
    if none_trains:
        text = (
            f"no row of {several(none_trains)} trains, expected one or more of each class; record "
            "more rows, or change training.split or training.seed"
        )
        found.append(Finding(FAULT, subject, text))
    once = [label for label, n in zip(scene.labels, rows, strict=True) if n == 1]
    if once:
        text = f"{several(once)} stands in a single row, which cannot both train and test"
        found.append(Finding(WARNING, subject, text))
    unseen = [label for label, n in zip(scene.labels, held, strict=True) if not n]
    if unseen:
        text = f"no row of {several(unseen)} is held out: the errors say nothing about it"
        found.append(Finding(WARNING, subject, text))
    if rows.max() > UNEQUAL * rows.min():
        text = (
            f"classes are unequal: who always said {scene.labels[int(rows.argmax())]!r} would be "
            f"right in {100 * rows.max() / rows.sum():.0f} % of the rows"
        )
        found.append(Finding(WARNING, subject, text))
    return found


def perhaps_labels(name: str, values: Real) -> list[Finding]:
    """Find a column of numbers that may hold labels."""
    numbers = np.unique(values)
    few = 2 < len(numbers) <= MOST_NUMBERS and ROWS_EACH * len(numbers) <= len(values)
    if not few or not np.array_equal(numbers, numbers.round()):
        return []
    text = (
        f"holds only the whole numbers {numbers[0]:g} to {numbers[-1]:g}; if they are names of "
        f"classes and no quantity, CLASSES={name} writes a scene that tells these apart"
    )
    return [Finding(NOTE, name, text)]
