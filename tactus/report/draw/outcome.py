"""Draws the errors of a scene: computed against recorded, along positions, with disturbances."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from golden.numbers.real import Real
from tactus.errors import UNKNOWN, Decisions, held_out_or_all, percent, trained_means
from tactus.report.draw.svg import GROUPS, PLOT_INCHES, Picture, plain, style, svg
from tactus.report.measure.outcome import KINDS, NONE, Outcome
from tactus.report.measure.table import Cell, Table
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


# More points make the page large without showing more.
POINTS = 600
HEIGHT = 5.4
# More numbers, such as 0.0025, would overlap.
TICKS = 5
LINES = ("-", "--", ":", "-.")
# Labels of more letters stand below each other, and each makes the plot so many inches taller.
LONG, LINE = 26, 0.12


@dataclass(frozen=True)
class Plot:
    """Lines of errors or, with ``recorded``, points of one output.

    name: The file name without suffix, of letters, digits and ``_``.
    title, across, up: The heading and the labels of the axes, with units.
    groups: The points of each line, by its label, shape (2, points).
    sentence: A sentence that the figures support.
    recorded: Whether computed values stand against recorded ones, and below the difference.
    """

    name: str
    title: str
    across: str
    up: str
    groups: Mapping[str, Real]
    sentence: str
    recorded: bool = False

    def draw(self) -> Picture:
        with style():
            count, (width, height) = len(self.groups), PLOT_INCHES
            columns = 2 if count > 3 else count
            if columns > 1 and max(map(len, self.groups)) > LONG:
                columns, height = 1, height + count * LINE
            size = (width, HEIGHT if self.recorded else height)
            figure = Figure(figsize=size, layout="constrained")
            if self.recorded:
                axes, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
                self._against(axes, below)
            else:
                axes = figure.subplots()
                self._lines(axes)
            if count > 1:
                labelled = axes.get_legend_handles_labels()
                figure.legend(*labelled, loc="outside lower center", ncols=columns)
            drawn = svg(figure, self.name, self.title)
        return Picture(self.name, self.title, drawn, self.sentence)

    def _lines(self, axes: Axes) -> None:
        axes.set(prop_cycle=GROUPS, xlabel=self.across, ylabel=self.up)
        for i, (label, points) in enumerate(self.groups.items()):
            axes.plot(*points, linestyle=LINES[i // 2 % len(LINES)], label=label)
        axes.locator_params(axis="x", nbins=TICKS)
        axes.set_ylim(bottom=0)

    def _against(self, above: Axes, below: Axes) -> None:
        above.set(prop_cycle=GROUPS, ylabel=self.up)
        below.set(prop_cycle=GROUPS, ylabel="computed - recorded", xlabel=self.across)
        for label, (x, y) in self.groups.items():
            for axes, values in ((above, y), (below, y - x)):
                axes.plot(x, values, linestyle="none", markersize=3, label=label)
        above.axline((float(x[0]), float(x[0])), slope=1, color="black", linewidth=0.6)
        below.axhline(0, color="black", linewidth=0.6)


def predicted_plots(found: Outcome) -> Iterator[Plot]:
    count = len(found.errors)
    every = -(-count // POINTS)
    for c, output in enumerate(found.scene.outputs):
        drawn = np.arange(count) % every == 0
        worst = int(np.argmax(found.errors[:, c]))
        drawn[worst] = True
        groups = {"rows": drawn}
        if found.held_out is not None:
            held = np.zeros(count, bool)
            held[found.held_out] = True
            groups = {"trained or chose": drawn & ~held, "held out": drawn & held}
        pairs = np.array([found.targets[:, c], found.results[:, c]])
        miss = pairs[1] - pairs[0]
        text = f"Every {every}th row and the worst. " if every > 1 else ""
        if found.held_out is None and trained_means(found.scene, "test_mean_percent") is None:
            text += f"Held-out rows: {UNKNOWN}. "
        yield Plot(
            f"predicted_{c}",
            f"{output}: computed against recorded",
            f"{plain(output)}, recorded",
            f"{plain(output)}, computed",
            {label: pairs[:, rows] for label, rows in groups.items() if rows.any()},
            f"{text}Differences are {miss.mean():+.2g} in the mean, with a standard deviation of "
            f"{miss.std():.2g}; the largest error is {found.errors[worst, c]:.2f} %, in row "
            f"{found.numbers[worst]}.",
            recorded=True,
        )


def _number(cell: Cell) -> float:
    return float(str(cell))


def along_plot(found: Outcome, table: Table) -> Plot:
    names = [f"{row[0]:g}" if isinstance(row[0], float) else str(row[0]) for row in table.rows]
    texts = any(isinstance(row[0], str) for row in table.rows)
    places = [number if texts else _number(row[0]) for number, row in enumerate(table.rows, 1)]
    outputs = found.scene.outputs
    columns = [[_number(row[2 + c]) for row in table.rows] for c in range(len(outputs))]
    error, place, name = max(
        one
        for name, errors in zip(outputs, columns, strict=True)
        for one in zip(errors, names, [name] * len(names), strict=True)
    )
    return Plot(
        "along",
        f"Mean error along {found.scene.group_by}",
        plain(found.scene.group_by) + (", in the order of the table" if texts else ""),
        "mean error %",
        {
            plain(name): np.array([places, errors])
            for name, errors in zip(outputs, columns, strict=True)
        },
        f"The largest is that of {name} at {place}, {error:.2f} %.",
    )


def disturbance_plots(table: Table) -> Iterator[Plot]:
    outputs = [column.removesuffix(" %") for column in table.columns[2:]]
    for key, (kind, _) in KINDS.items():
        rows = [row for row in table.rows if row[0] in (NONE, kind)]
        errors = {
            name: np.array([[_number(row[i]) for row in rows] for i in (1, c)])
            for c, name in enumerate(outputs, 2)
        }
        largest = max(outputs, key=lambda name: errors[name][1, -1])
        (*_, size), (recorded, *_, error) = errors[largest]
        text = f"{largest} is the worst at {size:g}: {error:.2g} %, {recorded:.2g} % as recorded."
        unit = "part of the reading" if key == "gain" else "unit of the readings"
        yield Plot(
            f"disturbed_{key}",
            f"Mean error against {kind}",
            f"{kind}, {unit}",
            "mean error %",
            {plain(name): points for name, points in errors.items()},
            text,
        )
