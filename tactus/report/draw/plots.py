"""Plots of error against cost, as groups of points on logarithmic axes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from tactus.report.draw.svg import PLOT_INCHES, Look, nth, style, svg

Points = Sequence[tuple[float, float]]
# If the ends of an axis have a smaller ratio, powers of ten alone give too few numbers.
FEW = 300
# More numbers, such as 0.0025, would overlap on a linear axis across.
TICKS = 5
# Labels of more letters stand below each other, and each makes the plot so many inches taller.
LONG, LINE = 26, 0.12
_LINES = ("-", "--", ":", "-.")


@dataclass(frozen=True)
class Plot:
    """One plot and the sentence that its figures support.

    name: The file name without suffix, of letters, digits and ``_``.
    title, across, up: The heading and the labels of the axes, with units.
    groups: The points by label. A value of 0 has no place on a logarithmic axis and is drawn at
        ``floor``.
    sentence: A sentence that the figures support.
    joined: Whether a line joins the points of a group in their order.
    linear: The linear axes: any of "x" and "y". A linear y begins at 0.
    levels: Horizontal lines to compare with.
    tables: The tables that hold every number of the plot.
    looks: The looks by label, for activations and networks. Others have those of ``looks.nth``.
    floor: The value at which an error of 0 is drawn.
    """

    name: str
    title: str
    across: str
    up: str
    groups: Mapping[str, Points]
    sentence: str
    tables: Sequence[str]
    joined: bool = True
    linear: str = ""
    levels: Mapping[str, float] = field(default_factory=dict)
    looks: Mapping[str, Look] = field(default_factory=dict)
    floor: float = 1e-17

    def __post_init__(self) -> None:
        empty = [label for label, points in self.groups.items() if not points]
        if not self.groups or empty:
            raise ValueError(f"plot {self.name}: no points for {', '.join(empty) or 'any group'}")

    def draw(self) -> str:
        """The plot as an ``<svg>`` element."""
        with style():
            count, (width, height) = len(self.groups), PLOT_INCHES
            columns = 2 if count > 3 else count
            if columns > 1 and max(map(len, self.groups)) > LONG:
                columns, height = 1, height + count * LINE
            figure = Figure(figsize=(width, height), layout="constrained")
            self.fill(figure.add_subplot(), list(self.groups))
            if count > 1:
                figure.legend(loc="outside lower center", ncols=columns)
            return svg(figure, self.name)

    def fill(self, axes: Axes, labels: Sequence[str]) -> None:
        """Draw the plot into axes. The look of a group follows from its place among the labels."""
        for label, points in self.groups.items():
            i = labels.index(label)
            look = self.looks.get(label) or nth(i)
            axes.plot(
                [x for x, _ in points],
                [y if "y" in self.linear else max(y, self.floor) for _, y in points],
                marker=look.marker,
                color=look.colour,
                markerfacecolor=None if look.filled else "white",
                linestyle=_LINES[i // 2 % len(_LINES)] if self.joined else "none",
                label=label,
            )
        for i, (label, height) in enumerate(self.levels.items()):
            axes.axhline(height, color="black", linewidth=0.8, linestyle=_LINES[1 + i % 3])
            axes.annotate(
                label,
                (1, height),
                xycoords=("axes fraction", "data"),
                xytext=(0, 2),
                textcoords="offset points",
                ha="right",
                fontsize=8,
            )
        if "x" in self.linear:
            axes.locator_params(axis="x", nbins=TICKS)
        else:
            axes.set_xscale("log")
            _label(axes.xaxis)
        if "y" in self.linear:
            axes.set_ylim(bottom=0)
        else:
            axes.set_yscale("log")
            _label(axes.yaxis)
        axes.set_xlabel(self.across)
        axes.set_ylabel(self.up)


def _label(axis: Axis) -> None:
    """Put numbers at 1, 2 and 5 of every decade if there are few decades."""
    low, high = axis.get_view_interval()
    if high / low < FEW:
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axis.set_minor_formatter(NullFormatter())
