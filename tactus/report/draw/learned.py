"""Draws the functions of networks of learned functions, with the rows of the data below each."""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from golden.networks.function_sums import Curve, function_sums
from golden.numbers.real import Real
from golden.trained.dense import Trained
from golden.trained.function import ITSELF
from tactus.report.draw.drawing import ACCENT, FAINT, Point, box, group, line, picture, text
from tactus.scene import Scene

# The points of a curve, and the steps over which rows are counted.
POINTS, BINS = 25, 24
LEFT, TOP = 64.0, 66.0
# A cell holds one function: its size, the part that the curve has, and the gaps between cells.
CELL, CURVE, GAP = (64.0, 44.0), 32.0, 6.0
# The gap between the networks.
BETWEEN = 22.0
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
        return "straight" if all(one == ITSELF for one in self.curve.functions) else "curved"

    @property
    def values(self) -> Real:
        """The function over the range of x, without its mean at x."""
        return self.at(np.linspace(self.x.min(), self.x.max(), POINTS)) - self.at(self.x).mean()


# The functions of its inputs, and those of its sum.
Node = tuple[list[Edge], list[Edge]]


def nodes_of(
    network: Trained, inputs: Real, names: Sequence[str], outputs: Sequence[str]
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
    body = [
        text((6, 18), f"The functions that scene {scene.name} has learned", 13, font_weight="bold"),
        text((6, 36), "each line is a node: the functions of its inputs, and right the function"),
        text((6, 51), "of their sum; below: how many rows of the data lie there"),
    ]
    y = TOP
    for name, nodes in networks.items():
        body.append(text((6, y + 12), name, font_weight="bold"))
        inner, outer = nodes[0]
        sums = enumerate((f"for {edge.of}" for edge in outer), columns)
        for c, heading in [*enumerate(edge.of for edge in inner), *sums]:
            body.append(text((_x(c), y + 12), heading, 10))
        y += 18
        # All functions of sums have one scale, and those of the inputs of one node.
        most = _height(edge for _, outer in nodes for edge in outer)
        for n, (inner, outer) in enumerate(nodes, 1):
            body.append(text((6, y + CURVE / 2 + 4), f"node {n}"))
            own = _height(inner)
            for c, edge in enumerate(inner):
                told = f"{name}, node {n}, {edge.of}: {edge.form}"
                body.append(group(_function(edge, (_x(c), y), own), told))
            for c, edge in enumerate(outer, columns):
                told = f"{name}, node {n}, sum for {edge.of}: {edge.form}"
                body.append(group(_function(edge, (_x(c), y), most), told))
            y += CELL[1] + GAP
        y += BETWEEN - GAP
    counts = Counter(edge.form for node in every for side in node for edge in side)
    forms = ", ".join(f"{counts[form]} {form}" for form in ("curved", "straight", "flat"))
    title = f"Learned functions of {', '.join(networks)}: {forms}."
    width = _x(columns + max(len(outer) for _, outer in every)) + 6
    return picture(title, (width, y), body, narrowest=560, widest=720)


def _x(column: int) -> float:
    return LEFT + column * (CELL[0] + GAP)


def _height(edges: Iterable[Edge]) -> float:
    """The largest value of some functions, which all have the same scale."""
    return max((float(np.abs(edge.values).max()) for edge in edges), default=1.0) or 1.0


def _function(edge: Edge, at: Point, most: float) -> list[str]:
    """One function with the rows below it; a flat one is an empty frame."""
    x, y = at
    width, height = CELL
    body = [box(at, CELL, stroke=FAINT, stroke_width=0.5)]
    if edge.form != "flat":
        middle = y + CURVE / 2
        points = [
            (x + width * n / (POINTS - 1), middle - value / most * (CURVE / 2 - 2))
            for n, value in enumerate(edge.values.tolist())
        ]
        colour = ACCENT if edge.form == "curved" else FAINT
        body.append(line(points, stroke=colour, stroke_width=1.4))
    bottom = y + height
    outline = [(x, bottom)]
    for n, count in enumerate(np.histogram(edge.x, BINS)[0].tolist()):
        top = bottom - min(count / len(edge.x) / FULL, 1.0) * (height - CURVE)
        outline += [(x + width * n / BINS, top), (x + width * (n + 1) / BINS, top)]
    return [*body, line([*outline, (x + width, bottom)], stroke=FAINT, stroke_width=0.8)]
