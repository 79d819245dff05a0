"""Draws the confusion matrix of a scene with classes."""

import numpy as np
from matplotlib.figure import Figure

from tactus.errors import Decisions, held_out_or_all, percent
from tactus.report.draw.svg import Picture, plain, style, svg
from tactus.scene import Scene

# The side of a cell and the margin for labels, in inches.
CELL, LEAST, MARGIN = 0.34, 2.4, 1.2
# Cells with a larger part of the rows of their class are so dark that their number is white.
DARK = 0.55
NUMBER_SIZE = 7


def confusion(scene: Scene, every: Decisions) -> Picture:
    """How many rows of each class are decided as which: held-out rows or, if unknown, all rows."""
    found, rows = held_out_or_all(scene, every)
    counts = found.confusion
    parts = counts / np.maximum(counts.sum(axis=1, keepdims=True), 1)
    side = max(LEAST, CELL * len(found.labels)) + MARGIN
    names = [plain(label) for label in found.labels]
    with style():
        figure = Figure(figsize=(side, side), layout="constrained")
        axes = figure.subplots()
        # Squares as shapes stay sharp at every size, which an image in an SVG does not.
        axes.pcolormesh(parts, cmap="Blues", vmin=0, vmax=1, edgecolor="white", linewidth=0.6)
        for row, col in zip(*np.nonzero(counts), strict=True):
            axes.text(
                col + 0.5,
                row + 0.5,
                str(counts[row, col]),
                ha="center",
                va="center",
                fontsize=NUMBER_SIZE,
                color="white" if parts[row, col] > DARK else "black",
            )
        places = np.arange(len(names)) + 0.5
        axes.set_xticks(places, names, rotation=90 if max(map(len, names)) > 3 else 0)
        axes.set_yticks(places, names)
        axes.tick_params(length=0)
        axes.grid(visible=False)
        axes.set_aspect("equal")
        axes.invert_yaxis()
        axes.set_xlabel(f"{plain(scene.classes)}, decided")
        axes.set_ylabel(f"{plain(scene.classes)} of the row")
        title = f"{scene.classes}: decided against recorded"
        drawn = svg(figure, "confusion", title)
    return Picture(
        "confusion",
        title,
        drawn,
        f"Bit-true decisions on {rows}: {found.right} are right, "
        f"{percent(found.right, len(found.actual))}. {_most_wrong(found)}",
    )


def _most_wrong(found: Decisions) -> str:
    """A sentence on the two classes that are confused most often."""
    wrong = found.confusion
    np.fill_diagonal(wrong, 0)
    if not wrong.any():
        return "None is wrong."
    row, col = np.unravel_index(int(wrong.argmax()), wrong.shape)
    rows = "row" if wrong[row, col] == 1 else "rows"
    return (
        f"Most often, in {wrong[row, col]} {rows}, {found.labels[row]} is taken for "
        f"{found.labels[col]}."
    )
