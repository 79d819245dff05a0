"""Draws the networks of a scene: their inputs, their nodes, and where their outputs go."""

from itertools import pairwise
from typing import Any

from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from tactus.report.draw.svg import ACCENT, FAINT, INK, plain, style, svg
from tactus.scene import Scene

# Lengths are points: from one terminal or node to the next, and from column to column; the room
# of a network's heading, and that below a network.
TERMINAL, NODE, SPAN, HEADING, BELOW = 11.0, 7.0, 46.0, 18.0, 12.0
# More hidden nodes than this are not drawn one by one. Their number is always written.
MOST_NODES = 40
# A wider picture, in CSS pixels, scrolls on a telephone before its letters are small.
LARGE, LEAST = 500.0, 0.75

Point = tuple[float, float]


def network(scene: Scene) -> str:
    """A row for each network, with the names of its inputs at the left and of its outputs.

    In a cascade, the inputs that are outputs of earlier networks have coloured names.

    Returns: One ``<svg>`` element.
    """
    shapes, count = [network.shape for network in scene.networks()], len(scene.members)
    words = {
        "single": "One network",
        "multiple": f"{count} independent networks",
        "cascade": f"{count} networks in cascade",
    }[scene.arrangement]
    names, y = [*scene.inputs, *scene.outputs], 0.0
    with style():
        figure = Figure()
        axes = figure.add_axes((0, 0, 1, 1))
        axes.axis("off")
        title = f"{words}\nactivation: {scene.hidden_text()}"
        axes.set_title(title, loc="left", fontsize="small")
        for n, (shape, member) in enumerate(zip(shapes, scene.members, strict=True)):
            y, columns = _columns(shape, y)
            _nodes(axes, columns, shape[1:-1], f"hidden_{n}")
            for at, name in zip(columns[0], names, strict=False):
                colour = INK if name in scene.inputs else ACCENT
                _name(axes, name, at, -5, color=colour, ha="right")
            for at, name in zip(columns[-1], member.outputs, strict=True):
                arrow = {"arrowstyle": "<|-", "color": INK, "linewidth": 0.8, "shrinkB": 4}
                _name(axes, name, at, 18, arrowprops=arrow)
        wide, high = SPAN * (max(map(len, shapes)) - 1), y - BELOW
        axes.set(xlim=(0, wide), ylim=(high, 0))
        figure.set_size_inches(wide / 72, high / 72)
        figure.draw_without_rendering()
        width = 96 * figure.get_tightbbox().width
        ends = f"{', '.join(scene.sensors)} to {', '.join(scene.outputs)}"
        told = f"{words} of scene {scene.name}, {scene.describe()}: {ends}"
        least = LEAST * width if width > LARGE else 0
        return svg(figure, "network", told, narrowest=least, tight=True)


def _name(axes: Axes, name: str, at: Point, right: float, **look: Any) -> None:
    look |= {"textcoords": "offset points", "va": "center", "fontsize": "small"}
    axes.annotate(plain(name), at, (right, 0), **look)


def _columns(shape: tuple[int, ...], top: float) -> tuple[float, list[list[Point]]]:
    """Where the next network begins, and the nodes of this one, in a column for each layer."""
    pitches = [TERMINAL, *[NODE] * (len(shape) - 2), TERMINAL]
    counts = [shape[0], *(min(nodes, MOST_NODES) for nodes in shape[1:-1]), shape[-1]]
    high = max(pitch * count for pitch, count in zip(pitches, counts, strict=True))
    middle = top + HEADING + high / 2
    return top + HEADING + high + BELOW, [
        [(SPAN * c, middle + pitch * (n - (count - 1) / 2)) for n in range(count)]
        for c, (pitch, count) in enumerate(zip(pitches, counts, strict=True))
    ]


def _nodes(axes: Axes, columns: list[list[Point]], hidden: tuple[int, ...], name: str) -> None:
    """Weights as thin lines, hidden nodes as circles; three dots replace nodes in the middle."""
    inputs, *layers, outputs = columns
    circled = []
    for nodes, count in zip(layers, hidden, strict=True):
        middle = len(nodes) // 2
        dots = nodes[middle - 1 : middle + 2] if count > len(nodes) else []
        circled.append([node for node in nodes if node not in dots])
        if dots:
            axes.plot(*zip(*dots, strict=True), ".", color=INK, markersize=2, clip_on=False)
    weights = [
        (a, b)
        for before, after in pairwise([inputs, *circled, outputs])
        for a in before
        for b in after
    ]
    axes.add_collection(LineCollection(weights, colors=FAINT, linewidths=0.4, clip_on=False))
    look: dict[str, Any] = {
        "color": INK,
        "markerfacecolor": "white",
        "markeredgewidth": 0.8,
        "clip_on": False,
    }
    for n, nodes in enumerate(circled):
        axes.plot(*zip(*nodes, strict=True), "o", markersize=5, gid=f"{name}_{n}", **look)
    axes.plot(*zip(*inputs, strict=True), "o", color=INK, markersize=3, clip_on=False)
    axes.plot(*zip(*outputs, strict=True), "o", markersize=6.5, **look)
    counts = ", ".join(map(str, hidden)) or "no"
    words = f"{counts} hidden node{'' if sum(hidden) == 1 else 's'}"
    at = (columns[-1][0][0] / 2, min(y for nodes in columns for _, y in nodes) - HEADING / 2)
    axes.annotate(words, at, ha="center", va="center", fontsize="small", annotation_clip=False)
