"""Draws the networks of a scene: their inputs, their nodes, and where their outputs go."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from tactus.report.draw.drawing import (
    ACCENT,
    FAINT,
    INK,
    Point,
    arrow_head,
    dot,
    group,
    line,
    picture,
    text,
    text_width,
)
from tactus.scene import Scene

ROW, NODE, TERMINAL = 16.0, 9.0, 14.0
# The distance from one column of nodes to the next.
SPAN = 62.0
# In CSS pixels: to what a smaller picture is scaled up, and beyond what it scrolls on a telephone.
WIDEST, LARGE = 400.0, 500.0
# The room above the nodes for a heading, and below them.
HEADING, BELOW = 22.0, 16.0
# More hidden nodes than this are not drawn one by one. Their number is always written.
MOST_NODES = 40


@dataclass(frozen=True)
class Place:
    """The places of the nodes of one network."""

    top: float
    inputs: list[Point]
    hidden: list[list[Point]]
    outputs: list[Point]
    bottom: float


def network(scene: Scene) -> str:
    """A row for each network, with the names of its inputs at the left and of its outputs.

    In a cascade, the inputs that are outputs of earlier networks have coloured names.

    Returns: One ``<svg>`` element.
    """
    shapes = [network.shape for network in scene.networks()]
    inputs = [*scene.inputs, *scene.outputs]
    heading = _heading(scene)
    left = 12 + max(text_width(name) for name in inputs[: max(shape[0] for shape in shapes)])
    body = [text((6, 16), heading[0], 13, font_weight="bold"), text((6, 32), heading[1])]
    top = 39.0
    for shape, member in zip(shapes, scene.members, strict=True):
        place = _place(shape, left, top)
        for n, ((x, y), name) in enumerate(zip(place.inputs, inputs, strict=False)):
            colour = INK if n < len(scene.inputs) else ACCENT
            body.append(text((x - 6, y + 4), name, text_anchor="end", fill=colour))
        body += _nodes(place, shape[1:-1], member.outputs)
        top = place.bottom + BELOW
    columns = max(map(len, shapes)) - 1
    width = max(
        left + columns * SPAN + 24 + max(text_width(name, 12) for name in scene.outputs),
        *(12 + text_width(words, 12) for words in heading),
    )
    ends = f"{', '.join(scene.sensors)} to {', '.join(scene.outputs)}"
    told = f"{heading[0]} of scene {scene.name}, {scene.describe()}: {ends}"
    # Letters stay large enough to be read.
    narrowest = 0.75 * width if width > LARGE else 0
    return picture(told, (width, top - BELOW + 8), body, narrowest, max(width, WIDEST))


def _heading(scene: Scene) -> list[str]:
    count = len(scene.members)
    words = {
        "single": "One network",
        "multiple": f"{count} independent networks",
        "cascade": f"{count} networks in cascade",
    }
    return [words[scene.arrangement], f"activation: {scene.hidden_text()}"]


def _place(shape: tuple[int, ...], left: float, top: float) -> Place:
    """The nodes of a network, in a column for each layer; the columns have a common middle."""
    inputs, *hidden, outputs = shape
    shown = [min(nodes, MOST_NODES) for nodes in hidden]
    heights = [(inputs - 1) * TERMINAL, (max(shown, default=1) - 1) * NODE, (outputs - 1) * ROW]
    middle = top + HEADING + max(heights) / 2

    def column(count: int, pitch: float, x: float) -> list[Point]:
        return [(x, middle + pitch * (n - (count - 1) / 2)) for n in range(count)]

    return Place(
        top,
        column(inputs, TERMINAL, left),
        [column(nodes, NODE, left + SPAN * n) for n, nodes in enumerate(shown, start=1)],
        column(outputs, ROW, left + SPAN * (len(hidden) + 1)),
        top + HEADING + max(heights) + NODE / 2,
    )


def _nodes(place: Place, hidden: Sequence[int], names: tuple[str, ...]) -> list[str]:
    """Weights as thin lines, hidden nodes as circles, outputs with their names."""
    circled, dotted = [], []
    for nodes, count in zip(place.hidden, hidden, strict=True):
        # Three dots replace the nodes in the middle.
        middle = len(nodes) // 2
        dots = nodes[middle - 1 : middle + 2] if count > len(nodes) else []
        circled.append([node for node in nodes if node not in dots])
        dotted.append(dots)
    weights = [
        line([a, b], stroke=FAINT, stroke_width=0.4)
        for before, after in pairwise([place.inputs, *circled, place.outputs])
        for a in before
        for b in after
    ]
    body = [group(weights)]
    for nodes, dots, count in zip(circled, dotted, hidden, strict=True):
        circles = [dot(node, 3.4, fill="#fff", stroke=INK) for node in nodes]
        body.append(group([*circles, *(dot(node, 1) for node in dots)], f"{count} hidden nodes"))
    counts = ", ".join(map(str, hidden)) or "no"
    words = f"{counts} hidden node{'' if sum(hidden) == 1 else 's'}"
    left, right = place.inputs[0][0], place.outputs[0][0]
    # Without a hidden layer there is less room than the words take.
    centre = max((left + right) / 2, left + text_width(words) / 2)
    body.append(text((centre, place.top + 12), words, text_anchor="middle"))
    body += [dot(point, 2.4) for point in place.inputs]
    for (x, y), name in zip(place.outputs, names, strict=True):
        body += [
            line([(x, y), (x + 16, y)]),
            arrow_head((x + 18, y), (1, 0)),
            dot((x, y), 4.4, fill="#fff", stroke=INK),
            text((x + 22, y + 4), name, 12),
        ]
    return body
