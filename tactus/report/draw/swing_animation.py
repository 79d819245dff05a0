"""An animation of the swing, with the position of its mass that the hardware estimates."""

import numpy as np

from golden.input_error import InputError
from golden.numbers.real import Real
from tactus.report.draw.animation import steps
from tactus.report.draw.drawing import ACCENT, FAINT, INK, Point, dot, line, picture, text
from tactus.report.draw.swing import NAME, RUN, Followed, follow, without_past
from tactus.scene import Scene

# The seconds that are shown, and those of a step. A swing takes about one and a half.
FROM, UNTIL, STEP = 1.0, 5.0, 0.1
WIDTH, HEIGHT = 360.0, 220.0
# The scale of a millimetre, for y and z and for the wobble x, which is small.
ALONG, ACROSS = 0.52, 9.0
# The place of the mass at rest, and the middle of the view from above.
LEFT, REST, ABOVE = 180.0, 80.0, 170.0
OTHER = "#c43b3b"


def swing_animation(scene: Scene) -> str:
    """The true and the estimated mass, from the side (y and z) and from above (x and y).

    Each step is a frame of a run on which the networks were not trained. The animation needs no
    script: a style sheet moves it.

    scene: A scene with past samples of the swing. The scene without them is shown beside it.

    Returns: One ``<svg>`` element.
    """
    other = without_past(scene)
    if other is None:
        raise InputError(f"{scene.path}: swing: got no data.window, expected one")
    found = follow(scene, RUN, UNTIL)
    before = follow(other, RUN, UNTIL)
    shown = [int(np.argmin(np.abs(found.time - t))) for t in np.arange(FROM, UNTIL, STEP)]
    # Both estimates end at the same frame.
    skipped = len(before.time) - len(found.time)
    bodies = [_step(found, n, before.estimate[n + skipped]) for n in shown]
    title = f"The mass of the swing in {NAME}, true and as scene {scene.name} finds it"
    body = [*_still(), *steps("swing_animation", scene.name, STEP, bodies)]
    return picture(title, (WIDTH, HEIGHT), body)


def _side(place: Real) -> Point:
    """A place in the view from the side, of y and z."""
    return LEFT + ALONG * float(place[1]), REST - ALONG * float(place[2])


def _above(place: Real) -> Point:
    """A place in the view from above, of y and x."""
    return LEFT + ALONG * float(place[1]), ABOVE - ACROSS / 2 * float(place[0])


def _still() -> list[str]:
    """Everything that does not move."""
    return [
        dot((12, 12), 5, fill=ACCENT),
        text((24, 16), "true"),
        _ring((72, 12), INK),
        text((84, 16), "with past samples"),
        _ring((202, 12), OTHER),
        text((214, 16), "without"),
        text((8, 36), "from the side: y, z", 10),
        text((8, ABOVE - 40), f"from above: y, and x {ACROSS / 2 / ALONG:.0f} times as large", 10),
        line([(8, ABOVE), (WIDTH - 8, ABOVE)], stroke=FAINT, stroke_width=0.4),
    ]


def _ring(at: Point, colour: str) -> str:
    return dot(at, 5, fill="none", stroke=colour, stroke_width=1.4)


def _step(found: Followed, n: int, before: Real) -> list[str]:
    """The drawing of one frame."""
    true, estimate = found.true[n], found.estimate[n]
    body = [text((WIDTH - 8, 36), f"{found.time[n]:.2f} s", 10, text_anchor="end")]
    for view in (_side, _above):
        body += [
            dot(view(true), 5, fill=ACCENT),
            _ring(view(before), OTHER),
            _ring(view(estimate), INK),
        ]
    return body
