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

LANE, ROW, NODE, TERMINAL = 8.0, 16.0, 9.0, 14.0
# The distance from one column of nodes to the next.
SPAN = 62.0
# A smaller picture is scaled up to so many CSS pixels.
WIDEST = 460.0
# The room above the nodes for a heading, and below them for a line that takes an output back.
HEADING, BELOW = 22.0, 22.0
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
    """The sensors at the left, a row for each network, and the outputs at the right.

    The line of a sensor ends in an input for each sample that the network takes, with the newest
    first. In a cascade, a coloured line leads each output back to the networks after it.

    Returns: One ``<svg>`` element.
    """
    shapes = [network.shape for network in scene.networks()]
    sensors = len(scene.sensors)
    fed = scene.outputs[:-1] if scene.arrangement == "cascade" else ()
    names = 4 + max(text_width(name) for name in scene.sensors)
    # The line of the first sensor turns down farthest to the right, so that no two lines cross.
    lanes = [names + 12 + LANE * n for n in range(sensors)][::-1]
    lanes += [names + 12 + LANE * (sensors + n) for n in range(len(fed))]
    left = max(lanes) + 16
    heading = _heading(scene)
    places = []
    top = max(ROW * sensors + 8, 24 + 15.0 * (len(heading) - 1))
    for shape in shapes:
        places.append(_place(shape, left, top))
        top = places[-1].bottom + BELOW
    body = [text((left, 16), heading[0], 13, font_weight="bold")]
    body += [text((left, 17 + 15 * n), words) for n, words in enumerate(heading[1:], 1)]
    taps = scene.window.taps
    for k, name in enumerate(scene.sensors):
        at, last = 12 + ROW * k, max(n for n, tap in enumerate(taps) if tap.sensor == k)
        body.append(text((names, at + 4), name, text_anchor="end"))
        body.append(line([(names + 4, at), (lanes[k], at), (lanes[k], places[-1].inputs[last][1])]))
    for n in range(len(fed)):
        (x, y), turn, lane = places[n].outputs[0], places[n].bottom + 8, lanes[sensors + n]
        end = places[-1].inputs[len(taps) + n][1]
        body.append(line([(x, y), (x, turn), (lane, turn), (lane, end)], stroke=ACCENT))
    own = [lanes[tap.sensor] for tap in taps] + lanes[sensors:]
    for place in places:
        for (x, y), lane in zip(place.inputs, own, strict=False):
            colour = INK if lane in lanes[:sensors] else ACCENT
            body.append(line([(lane, y), (x, y)], stroke=colour))
            if place is not places[-1]:
                body.append(dot((lane, y), 1.8, fill=colour))
    for place, shape, member in zip(places, shapes, scene.members, strict=True):
        body += _nodes(place, shape[1:-1], member.outputs)
    columns = max(map(len, shapes)) - 1
    width = max(
        left + columns * SPAN + 24 + max(text_width(name, 12) for name in scene.outputs),
        left + max(text_width(words, 12) for words in heading),
    )
    ends = f"{', '.join(scene.sensors)} to {', '.join(scene.outputs)}"
    told = f"{heading[0]} of scene {scene.name}, {scene.describe()}: {ends}"
    # Letters stay large enough to be read.
    narrowest = 0.75 * width if width > WIDEST else 0
    return picture(told, (width, top - BELOW + 8), body, narrowest, max(width, WIDEST))


def _heading(scene: Scene) -> list[str]:
    count = len(scene.members)
    words = {
        "single": "One network",
        "multiple": f"{count} independent networks",
        "cascade": f"{count} networks in cascade",
    }
    past = [f"samples of so many frames before: {scene.window_text}"] if scene.window.past else []
    return [words[scene.arrangement], f"activation: {scene.hidden_text()}", *past]


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
