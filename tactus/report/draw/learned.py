"""Draws the functions of networks of learned functions, with the rows of the data below each."""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from golden.networks.table_sums import Curve, function_sums
from golden.numbers.real import Real
from golden.trained.dense import DenseNetwork
from golden.trained.function import ITSELF
from tactus.report.draw.svg import ACCENT, FAINT, plain, style, svg
from tactus.scene import Scene

# The points of a curve, and the steps over which rows are counted.
POINTS, BINS = 25, 24
# Lengths are points. A cell holds one function: its size, and the part that the curve has.
WIDE, HIGH, CURVE = 48.0, 33.0, 24.0
# From cell to cell, the room of a heading, and the gap between the networks.
ACROSS, DOWN, HEADING, BETWEEN = 53.0, 38.0, 14.0, 12.0
# The part of the rows that fills the strip below a curve.
FULL = 0.25


@dataclass(frozen=True)
class Edge:
    """A function of one variable, an input of a node or its sum.

    of: The name of the input, or of the output to which the function of the sum goes.
    curve: None for an edge that is left out.
    x: The variable in each row of the data.
    """

    of: str
    curve: Curve | None
    x: Real

    def at(self, x: Real) -> Real:
        return self.curve.at(x) if self.curve else np.zeros(len(x))

    @property
    def form(self) -> str:
        if self.curve is None:
            return "flat"
        return "straight" if all(one == ITSELF for *_, one in self.curve.terms) else "curved"

    @property
    def values(self) -> Real:
        """The function over the range of x, without its mean at x."""
        return self.at(np.linspace(self.x.min(), self.x.max(), POINTS)) - self.at(self.x).mean()


# The functions of its inputs, and those of its sum.
Node = tuple[list[Edge], list[Edge]]


def nodes_of(
    network: DenseNetwork, inputs: Real, names: Sequence[str], outputs: Sequence[str]
) -> Iterator[Node]:
    """The hidden nodes of a network; inputs, shape (rows, inputs)."""
    found = function_sums(network, (), "")
    for h, node in enumerate(found.hidden):
        inner = [Edge(names[i], node.curves.get(i), x) for i, x in enumerate(inputs.T)]
        s = sum((edge.at(edge.x) for edge in inner), np.full(len(inputs), node.constant))
        yield inner, [Edge(outputs[o], out.curves.get(h), s) for o, out in enumerate(found.outputs)]


def scene_nodes(scene: Scene) -> dict[str, list[Node]]:
    """The nodes of a scene's networks over its recorded rows, by the names of their outputs."""
    found = {}
    for n, network in enumerate(scene.networks()):
        outputs = scene.outputs if scene.arrangement == "single" else scene.outputs[n : n + 1]
        names = [*scene.inputs, *scene.outputs]
        inputs = scene.inputs_of(network)
        found[", ".join(outputs)] = list(nodes_of(network, inputs, names, outputs))
    return found


def learned_curves(scene: Scene) -> str:
    """A line for each node, and a column for each input and for each function of a sum.

    scene: One of learned functions.
    """
    networks = scene_nodes(scene)
    every = [node for nodes in networks.values() for node in nodes]
    columns = max(len(inner) for inner, _ in every)
    y = 0.0
    with style():
        figure = Figure()
        axes = figure.add_axes((0, 0, 1, 1))
        axes.axis("off")
        title = (
            f"The functions that scene {scene.name} has learned\n"
            "each line is a node: the functions of its inputs, and right the function\n"
            "of their sum; below: how many rows of the data lie there"
        )
        axes.set_title(plain(title), loc="left", fontsize="small")
        for name, nodes in networks.items():
            inner, outer = nodes[0]
            sums = enumerate((f"for {edge.of}" for edge in outer), columns)
            for c, heading in [*enumerate(edge.of for edge in inner), *sums]:
                _write(axes, (ACROSS * c, y + HEADING / 2), heading)
            _write(axes, (-4, y + HEADING / 2), name, ha="right", fontweight="bold")
            y += HEADING
            # All functions of sums have one scale, and those of the inputs of one node.
            most = _height(edge for _, outer in nodes for edge in outer)
            for n, (inner, outer) in enumerate(nodes, 1):
                _write(axes, (-4, y + CURVE / 2), f"node {n}", ha="right")
                own = _height(inner)
                for c, edge in enumerate(inner):
                    _function(axes, edge, (ACROSS * c, y), own)
                for c, edge in enumerate(outer, columns):
                    _function(axes, edge, (ACROSS * c, y), most)
                y += DOWN
            y += BETWEEN
        across = ACROSS * (columns + max(len(outer) for _, outer in every))
        axes.set(xlim=(0, across), ylim=(y - BETWEEN, 0))
        figure.set_size_inches(across / 72, (y - BETWEEN) / 72)
        counts = Counter(edge.form for node in every for side in node for edge in side)
        forms = ", ".join(f"{counts[form]} {form}" for form in ("curved", "straight", "flat"))
        told = f"Learned functions of {', '.join(networks)}: {forms}."
        return svg(figure, "functions", told, narrowest=560, tight=True)


def _write(axes: Axes, at: tuple[float, float], words: str, **look: Any) -> None:
    axes.text(*at, plain(words), va="center", fontsize="small", **look)


def _height(edges: Iterable[Edge]) -> float:
    """The largest value of some functions, which all have the same scale."""
    return max((float(np.abs(edge.values).max()) for edge in edges), default=1.0) or 1.0


def _function(axes: Axes, edge: Edge, at: tuple[float, float], most: float) -> None:
    """One function with the rows below it; a flat one is an empty frame."""
    x, y = at
    axes.add_patch(Rectangle(at, WIDE, HIGH, fill=False, edgecolor=FAINT, linewidth=0.4))
    if edge.form != "flat":
        values = y + CURVE / 2 - edge.values / most * (CURVE / 2 - 2)
        colour = ACCENT if edge.form == "curved" else FAINT
        axes.plot(np.linspace(x, x + WIDE, POINTS), values, color=colour, linewidth=1.1)
    part = np.minimum(np.histogram(edge.x, BINS)[0] / len(edge.x) / FULL, 1.0)
    bottom, steps = y + HIGH, np.linspace(x, x + WIDE, BINS + 1)
    tops = bottom - part * (HIGH - CURVE)
    axes.stairs(tops, steps, baseline=bottom, color=FAINT, linewidth=0.6)
