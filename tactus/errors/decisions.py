"""The decisions of a scene's network between classes, in floating point and in the hardware."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from golden.numbers.fixed import Codes
from tactus.errors.scene_errors import held_out_rows, provenances
from tactus.scene import Scene
from tactus.scene.labels import decided, margins

Numbers = NDArray[np.int64]


@dataclass(frozen=True)
class Decisions:
    """The classes of recorded rows, as numbers of labels.

    actual, real, bit_true, shape (rows,): The recorded class, that of the network in floating
        point, and that of the hardware.
    margins, shape (rows,): By how many codes the largest output of the hardware exceeds the second
        largest.
    """

    labels: tuple[str, ...]
    actual: Numbers
    real: Numbers
    bit_true: Numbers
    margins: Codes

    def take(self, rows: Numbers) -> Decisions:
        """The decisions for some of the rows."""
        parts = (self.actual, self.real, self.bit_true, self.margins)
        return Decisions(self.labels, *(part[rows] for part in parts))

    @property
    def right(self) -> int:
        """The number of rows that the hardware decides rightly."""
        return int((self.bit_true == self.actual).sum())

    @property
    def right_real(self) -> int:
        """The number of rows that the network in floating point decides rightly."""
        return int((self.real == self.actual).sum())

    @property
    def differ(self) -> int:
        """The number of rows that hardware and floating point decide differently."""
        return int((self.bit_true != self.real).sum())

    @property
    def confusion(self) -> Numbers:
        """The number of rows of each actual class (down) for each class decided (across)."""
        found = np.zeros((len(self.labels), len(self.labels)), dtype=np.int64)
        np.add.at(found, (self.actual, self.bit_true), 1)
        return found

    @property
    def text(self) -> str:
        """How many rows are decided rightly, as text."""
        rows = len(self.actual)
        return (
            f"{self.right} of {rows} right, {percent(self.right, rows)}; in floating point "
            f"{self.right_real}, {percent(self.right_real, rows)}; {self.differ} decided "
            "differently"
        )


def percent(part: int, of: int) -> str:
    """A part of rows in percent, as text."""
    return f"{100 * part / of:.1f} %" if of else "no rows"


def decisions_of(scene: Scene) -> Decisions:
    """The decisions on all recorded rows of a scene with classes."""
    vectors = scene.vectors()
    codes = scene.twin().core.process(vectors.codes)
    return Decisions(
        scene.labels,
        decided(vectors.targets),
        decided(scene.process_real(vectors.inputs)),
        decided(codes),
        margins(codes),
    )


def held_out_or_all(scene: Scene, every: Decisions) -> tuple[Decisions, str]:
    """The decisions on held-out rows, or on all rows if none are known to be held out.

    The text says which rows these are.
    """
    held = held_out_rows(scene)
    if held is not None:
        return every.take(held), f"{len(held)} held-out rows"
    return every, f"all {len(every.actual)} rows"


def held_out_line(scene: Scene, every: Decisions) -> str:
    """A text about the decisions on held-out rows, which are some of ``every``."""
    held = held_out_rows(scene)
    if held is not None:
        return every.take(held).text
    stories = provenances(scene)
    if stories is None:
        return "unknown: not trained here"
    wrong = stories[0].get("test_wrong_percent")
    return (
        f"none any more, the network was trained on with all; before, {100 - wrong:.1f} % were "
        "right"
        if wrong is not None
        else "unknown"
    )


def table_lines(found: Decisions) -> list[str]:
    """The confusion matrix as lines of text, with the part of each class that is right."""
    counts = found.confusion
    wide = max(6, *map(len, found.labels))
    lines = [" ".join(f"{text:>{wide}}" for text in ("", *found.labels, "right"))]
    for label, row, own in zip(found.labels, counts, counts.diagonal(), strict=True):
        cells = (str(n) if n else "." for n in row)
        right = percent(int(own), int(row.sum()))
        lines.append(" ".join(f"{text:>{wide}}" for text in (label, *cells, right)))
    return lines


def lines_of(scene: Scene) -> list[str]:
    """The lines that describe the decisions of a scene."""
    every = decisions_of(scene)
    found, rows = held_out_or_all(scene, every)
    return [
        f"decisions                 {every.text}",
        f"decisions, held out       {held_out_line(scene, every)}",
        f"{scene.classes} of the row (down) and as decided (across), {rows}:",
        *table_lines(found),
    ]
