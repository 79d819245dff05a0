"""Draws the errors of a scene: computed against recorded, along positions, with disturbances."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.figure import Figure

from tactus.errors.scene_errors import UNKNOWN, trained_means
from tactus.report.draw.plots import Plot
from tactus.report.draw.svg import PLOT_INCHES, nth, plain, style, svg
from tactus.report.measure.disturbance import BOUND, KINDS, NONE
from tactus.report.measure.outcome import Outcome
from tactus.report.measure.table import Table

# More points make the page large without showing more.
POINTS = 600
HEIGHT = 5.4

Points = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Predicted:
    """One output: the computed against the recorded values, and the difference below.

    name, title, sentence: See ``Plot``.
    output: The name of the output on the axes.
    groups: The recorded and the computed value of each row.
    """

    name: str
    title: str
    output: str
    groups: tuple[tuple[str, Points], ...]
    sentence: str

    def draw(self) -> str:
        """The picture as an ``<svg>`` element."""
        with style():
            figure = Figure(figsize=(PLOT_INCHES[0], HEIGHT), layout="constrained")
            above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
            for i, (label, points) in enumerate(self.groups):
                look = nth(i)
                x, y = np.array(points).T
                for axes, values in ((above, y), (below, y - x)):
                    axes.plot(
                        x,
                        values,
                        marker=look.marker,
                        color=look.colour,
                        linestyle="none",
                        markersize=3,
                        label=label,
                    )
            above.axline((float(x[0]), float(x[0])), slope=1, color="black", linewidth=0.6)
            below.axhline(0, color="black", linewidth=0.6)
            above.set_ylabel(f"{self.output}, computed")
            below.set_ylabel("computed - recorded")
            below.set_xlabel(f"{self.output}, recorded")
            if len(self.groups) > 1:
                handles, labels = above.get_legend_handles_labels()
                figure.legend(handles, labels, loc="outside lower center", ncols=2)
            return svg(figure, self.name)


def predicted_plots(found: Outcome) -> Iterator[Predicted]:
    """A picture for every output."""
    count = len(found.errors)
    for c, output in enumerate(found.scene.outputs):
        every = -(-count // POINTS)
        drawn = np.arange(count) % every == 0
        worst = int(np.argmax(found.errors[:, c]))
        drawn[worst] = True
        groups = {"rows": drawn}
        if found.held_out is not None:
            held = np.zeros(count, bool)
            held[found.held_out] = True
            groups = {"trained or chose": drawn & ~held, "held out": drawn & held}
        miss = found.results[:, c] - found.targets[:, c]
        text = f"Every {every}th row and the worst. " if every > 1 else ""
        if found.held_out is None and trained_means(found.scene, "test_mean_percent") is None:
            text += f"Held-out rows: {UNKNOWN}. "
        yield Predicted(
            f"predicted_{c}",
            f"{output}: computed against recorded",
            plain(output),
            tuple(
                (
                    label,
                    tuple(
                        zip(
                            found.targets[rows, c].tolist(),
                            found.results[rows, c].tolist(),
                            strict=True,
                        )
                    ),
                )
                for label, rows in groups.items()
                if rows.any()
            ),
            f"{text}Differences are {miss.mean():+.2g} in the mean, with a standard deviation of "
            f"{miss.std():.2g}; the largest error is {found.errors[worst, c]:.2f} %, in row "
            f"{found.numbers[worst]}.",
        )


def along_plot(found: Outcome, table: Table) -> Plot:
    """The mean errors against the position."""
    names = [f"{row[0]:g}" if isinstance(row[0], float) else str(row[0]) for row in table.rows]
    texts = any(isinstance(row[0], str) for row in table.rows)
    places = [number if texts else float(str(row[0])) for number, row in enumerate(table.rows, 1)]
    groups = {
        plain(name): [
            (place, float(str(row[2 + c]))) for place, row in zip(places, table.rows, strict=True)
        ]
        for c, name in enumerate(found.scene.outputs)
    }
    error, place, name = max(
        (float(str(row[2 + c])), place, name)
        for place, row in zip(names, table.rows, strict=True)
        for c, name in enumerate(found.scene.outputs)
    )
    return Plot(
        "along",
        f"Mean error along {found.scene.group_by}",
        plain(found.scene.group_by) + (", in the order of the table" if texts else ""),
        "mean error %",
        groups,
        f"The largest is that of {name} at {place}, {error:.2f} %.",
        [table.name],
        linear="xy",
    )


def disturbance_plots(table: Table) -> Iterator[Plot]:
    """The mean errors, and their bounds if known, against noise and drifts."""
    names = [column.removesuffix(" %") for column in table.columns[2:]]
    outputs = [name for name in names if not name.endswith(BOUND)]
    looks = {plain(name): nth(c) for c, name in enumerate(outputs)}
    looks |= {
        plain(name): replace(nth(outputs.index(name.removesuffix(BOUND))), filled=False)
        for name in names
        if name not in outputs
    }
    for key, (kind, _) in KINDS.items():
        rows = [row for row in table.rows if row[0] in (NONE, kind)]
        errors = {
            name: [
                (float(str(row[1])), float(str(row[2 + c])))
                for row in rows
                if row[2 + c] is not None
            ]
            for c, name in enumerate(names)
        }
        errors = {name: points for name, points in errors.items() if points}
        largest = max(outputs, key=lambda name: errors[name][-1][1])
        (_, recorded), *_, (size, error) = errors[largest]
        text = f"{largest} is the worst at {size:g}: {error:.2g} %, {recorded:.2g} % as recorded."
        allowed = [
            f"{points[-1][1]:.2g} % of {name.removesuffix(BOUND)}"
            for name, points in errors.items()
            if name not in outputs
        ]
        if allowed:
            text += f" The sensors allow {', '.join(allowed)} there."
        unit = "part of the reading" if key == "gain" else "unit of the readings"
        yield Plot(
            f"disturbed_{key}",
            f"Mean error against {kind}",
            f"{kind}, {unit}",
            "mean error %",
            {plain(name): points for name, points in errors.items()},
            text,
            [table.name],
            linear="xy",
            looks=looks,
        )
