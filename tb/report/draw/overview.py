"""Draws what tactus does, for the first screen: a finger on a beam, networks on a chip, a load.

It has no background, and its ink is light where the page is dark.
"""

from itertools import pairwise

import numpy as np

from golden.physics.beam import Beam
from golden.scene import Scene
from hdl.synth.budget import budget_path, read_budget
from tb.report.draw.drawing import Point, arrow_head, box, dot, group, line, number, text
from tb.report.draw.load import FRAME, beam

SIZE = (900.0, 290.0)
INK, FAINT, ACCENT, SOFT = "var(--ink)", "var(--faint)", "var(--accent)", "var(--soft)"
STYLE = (
    "<style>svg{--ink:#1f2328;--faint:#818b98;--accent:#0969da;--soft:#eaeef2}"
    "@media(prefers-color-scheme:dark)"
    "{svg{--ink:#e6edf3;--faint:#8b949e;--accent:#58a6ff;--soft:#21262d}}</style>"
)
# The beam, the chip and the curve stand side by side.
ROOT, TIP, LEVEL = 40.0, 300.0, 150.0
CHIP: Point = (390.0, 40.0)
CHIP_SIZE: Point = (190.0, 210.0)
CURVE, CURVE_WIDTH, GROUND, TALL = 660.0, 220.0, 225.0, 130.0


def overview(scene: Scene, frame: int = FRAME) -> str:
    """The scene's hardware with its recorded cells, and what its networks say of a recorded frame.

    Returns: One ``<svg>`` element.
    """
    body = [*_beam(scene, frame), *_chip(scene), *_curve(scene, frame)]
    width, height = (number(value) for value in SIZE)
    head = f'viewBox="0 0 {width} {height}" role="img" font-family="sans-serif" fill="{INK}"'
    title = "A finger bends a beam; four gauges; networks on a chip; the load that they compute"
    inside = "".join([f"<title>{title}</title>", STYLE, *body])
    return f'<svg xmlns="http://www.w3.org/2000/svg" {head}>{inside}</svg>\n'


def _beam(scene: Scene, frame: int) -> list[str]:
    """The bent beam by equation 3.1, with its bend drawn large, and a finger where the load is."""
    rod, known = Beam(), beam(scene)
    load, centre = known.targets[frame, :2]
    place = centre * known.mm / 1e3
    along = np.linspace(0, rod.length, 40)
    bend = rod.deflection(along, load, place)
    drop = -bend / np.abs(bend).max() * 38
    across = ROOT + (TIP - ROOT) * along / rod.length
    points: list[Point] = [(float(x), float(LEVEL + y)) for x, y in zip(across, drop, strict=True)]
    at = float(ROOT + (TIP - ROOT) * place / rod.length)
    under = float(LEVEL + np.interp(place, along, drop)) - 4
    finger = (
        f'<path d="M{number(at - 13)} 40V{number(under - 13)}a13 13 0 0 0 26 0V40" fill="{SOFT}" '
        f'stroke="{INK}" stroke-width="1.5"/>'
    )
    gauges = []
    for n in range(len(scene.sensors)):
        x, y = points[4 + 7 * n]
        gauges.append(box((x - 8, y + 5), (16, 7), fill=ACCENT, stroke="none"))
        gauges.append(
            line([(x, y + 12), (x, 226 + 8 * n), (CHIP[0] - 7, 226 + 8 * n)], stroke=FAINT)
        )
    return [
        box((ROOT - 16, LEVEL - 34), (16, 68), fill=SOFT, stroke=INK),
        finger,
        line(points, stroke=INK, stroke_width=7, stroke_linecap="round"),
        *gauges,
        arrow_head((CHIP[0], 238), (1, 0), FAINT),
        text((ROOT - 16, 24), "something touches a beam", 14, font_weight="bold"),
        text(
            (ROOT - 16, 278),
            f"{len(scene.sensors)} gauges feel it, all of them a little",
            13,
            fill=FAINT,
        ),
    ]


def _chip(scene: Scene) -> list[str]:
    """The networks of the scene, each with its nodes, on a chip with its recorded cells."""
    (x, y), (width, _) = CHIP, CHIP_SIZE
    shapes = [network.shape for network in scene.networks()]
    cells = read_budget(budget_path(scene.path))["xc2v"][scene.twin().entity]
    body = [box(CHIP, CHIP_SIZE, fill=SOFT, stroke=INK, rx=6)]
    for n in range(7):
        at = y + 18 + 29 * n
        body += [line([(x - 7, at), (x, at)]), line([(x + width, at), (x + width + 7, at)])]
    body = [part.replace('stroke="#111"', f'stroke="{INK}"') for part in body]
    for n, (shape, name) in enumerate(zip(shapes, scene.outputs, strict=True)):
        row = y + 24 + 34 * n
        places = [
            [(x + 22 + 34 * c, row + 13 - 26 * (k + 0.5) / nodes) for k in range(nodes)]
            for c, nodes in enumerate(shape)
        ]
        joined = [
            line([a, b], stroke=FAINT, stroke_width=0.5)
            for left, right in pairwise(places)
            for a in left
            for b in right
        ]
        nodes = [dot(at, 2.2, fill=ACCENT) for layer in places for at in layer]
        body.append(group([*joined, *nodes]))
        body.append(text((x + 112, row + 4), name, 13))
    cost = f"{cells['LUT']} LUTs, {cells['multiplier']} multiplier"
    micros = scene.twin().output_clocks[-1] / scene.clock_mhz
    return [
        *body,
        line([(x + 14, y + 158), (x + width - 14, y + 158)], stroke=FAINT),
        text((x + 16, y + 178), cost, 13),
        text((x + 16, y + 197), f"{micros:.1f} µs, every frame proved", 12),
        text((x, 24), f"{len(shapes)} small networks on a chip", 14, font_weight="bold"),
        text((x, 278), "plain VHDL, bit for bit the model", 13, fill=FAINT),
    ]


def _curve(scene: Scene, frame: int) -> list[str]:
    """The load along the beam that the outputs of a recorded frame say, and the recorded one."""
    known = beam(scene)
    at, height = known.true(frame)
    fine = np.linspace(0, 1e3 * Beam().length, 160)
    found = known.exact(frame, fine)
    top = max(float(height.max()), float(found.max()))

    def place(millimetres: float, value: float) -> Point:
        share = millimetres / fine[-1]
        return CURVE + CURVE_WIDTH * float(share), GROUND - TALL * float(value) / top

    recorded = [place(m, v) for m, v in zip(at, height, strict=True)]
    computed = [place(m, v) for m, v in zip(fine, found, strict=True)]
    end = CHIP[0] + CHIP_SIZE[0]
    return [
        line([(end + 10, 145), (CURVE - 16, 145)], stroke=FAINT, stroke_width=1.5),
        arrow_head((CURVE - 10, 145), (1, 0), FAINT),
        line([(CURVE, GROUND), (CURVE + CURVE_WIDTH, GROUND)], stroke=FAINT),
        line(recorded, stroke=FAINT, stroke_width=1.5, stroke_dasharray="5 4"),
        line(computed, stroke=ACCENT, stroke_width=2.5),
        text((CURVE, 24), "what touched it, and where", 14, font_weight="bold"),
        text((CURVE, 44), ", ".join(scene.outputs), 13),
        text(
            (CURVE + CURVE_WIDTH, GROUND + 16), "along the beam", 12, text_anchor="end", fill=FAINT
        ),
        text((CURVE, 278), "computed, and as recorded (dashed)", 13, fill=FAINT),
    ]
