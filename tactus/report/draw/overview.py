"""Draws the pictures of the first screen: what tactus does, and what it was asked to show.

They have no background, and their ink is light where the page is dark.
"""

from collections import Counter
from itertools import pairwise
from math import ceil, log10

import numpy as np

from tactus.physics.beam import Beam
from tactus.report.draw.drawing import Point, arrow_head, box, dot, group, line, number, text
from tactus.report.draw.load import FRAME, beam
from tactus.report.draw.run_time import AFTER, scene_of
from tactus.report.measure.table import Row
from tactus.report.measure.table import number as cell
from tactus.scene import Scene, thesis_table
from tactus.synth.budget import read_budget

SIZE = (680.0, 276.0)
INK, FAINT, ACCENT, SOFT = "var(--ink)", "var(--faint)", "var(--accent)", "var(--soft)"
STYLE = (
    "<style>svg{--ink:#1f2328;--faint:#818b98;--accent:#0969da;--soft:#eaeef2}"
    "@media(prefers-color-scheme:dark)"
    "{svg{--ink:#e6edf3;--faint:#8b949e;--accent:#58a6ff;--soft:#21262d}}</style>"
)
# The beam, the chip and the curve stand side by side: small enough to be read on a telephone.
ROOT, TIP, LEVEL = 30.0, 214.0, 130.0
CHIP: Point = (256.0, 34.0)
CHIP_SIZE: Point = (176.0, 190.0)
CURVE, CURVE_WIDTH, GROUND, TALL = 480.0, 190.0, 196.0, 106.0
WISHES_SIZE = (680.0, 216.0)
# The pictures of wishes: left edges and width, and where their areas begin and end.
LEFT, WIDTH, TOP, BOTTOM = (10.0, 250.0, 490.0), 180.0, 46.0, 172.0
# The longest time and the largest error of the first picture, and the least part of the second.
MICROS, ERROR, LEAST = (0.05, 100.0), 3.0, -6


def overview(scene: Scene, frame: int = FRAME) -> str:
    """The scene's hardware with its recorded cells, and what its networks say of a recorded frame.

    Returns: One ``<svg>`` element.
    """
    body = [*_beam(scene, frame), *_chip(scene), *_curve(scene, frame)]
    title = "A finger bends a beam; four gauges; networks on a chip; the load that they compute"
    return _whole(title, SIZE, body)


def _whole(title: str, size: Point, body: list[str]) -> str:
    width, height = (number(value) for value in size)
    head = f'viewBox="0 0 {width} {height}" role="img" font-family="sans-serif" fill="{INK}"'
    inside = "".join([f"<title>{title}</title>", STYLE, *body])
    return f'<svg xmlns="http://www.w3.org/2000/svg" {head}>{inside}</svg>\n'


def _captioned(x: float, heading: str, *below: str) -> list[str]:
    """What stands above and below a part of the picture."""
    lines = [text((x, 248 + 18 * n), words, 14, fill=FAINT) for n, words in enumerate(below)]
    return [text((x, 20), heading, 15, font_weight="bold"), *lines]


def _beam(scene: Scene, frame: int) -> list[str]:
    """The bent beam by equation 3.1, with its bend drawn large, and a finger where the load is."""
    rod, known = Beam(), beam(scene)
    load, centre = known.targets[frame, :2]
    place = centre * known.mm / 1e3
    along = np.linspace(0, rod.length, 40)
    bend = rod.deflection(along, load, place)
    drop = -bend / np.abs(bend).max() * 34
    across = ROOT + (TIP - ROOT) * along / rod.length
    points: list[Point] = [(float(x), float(LEVEL + y)) for x, y in zip(across, drop, strict=True)]
    at = float(ROOT + (TIP - ROOT) * place / rod.length)
    under = float(LEVEL + np.interp(place, along, drop)) - 4
    finger = (
        f'<path d="M{number(at - 12)} 36V{number(under - 12)}a12 12 0 0 0 24 0V36" fill="{SOFT}" '
        f'stroke="{INK}" stroke-width="1.5"/>'
    )
    gauges = []
    for n in range(len(scene.sensors)):
        (x, y), wire = points[5 + 8 * n], 200 + 7 * n
        gauges.append(box((x - 7, y + 5), (14, 7), fill=ACCENT, stroke="none"))
        gauges.append(line([(x, y + 12), (x, wire), (CHIP[0] - 7, wire)], stroke=FAINT))
    return [
        box((ROOT - 14, LEVEL - 32), (14, 64), fill=SOFT, stroke=INK),
        finger,
        line(points, stroke=INK, stroke_width=7, stroke_linecap="round"),
        *gauges,
        arrow_head((CHIP[0], 210), (1, 0), FAINT),
        *_captioned(
            ROOT - 14,
            "a finger bends a beam",
            f"{len(scene.sensors)} gauges: each feels",
            "a little of everything",
        ),
    ]


def _chip(scene: Scene) -> list[str]:
    """The networks of the scene, each with its nodes, on a chip with its recorded cells."""
    (x, y), (width, _) = CHIP, CHIP_SIZE
    shapes = [network.shape for network in scene.networks()]
    cells = read_budget(scene.path)["xc2v"][scene.twin().entity]
    body = [box(CHIP, CHIP_SIZE, fill=SOFT, stroke=INK, rx=6)]
    for n in range(7):
        at = y + 17 + 26 * n
        body += [line([(side, at), (side + 7, at)], stroke=INK) for side in (x - 7, x + width)]
    for n, (shape, name) in enumerate(zip(shapes, scene.outputs, strict=True)):
        row = y + 22 + 31 * n
        places = [
            [(x + 22 + 34 * c, row + 12 - 24 * (k + 0.5) / nodes) for k in range(nodes)]
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
        body.append(text((x + 104, row + 5), name, 14))
    share = cells["LUT"] / thesis_table("device")["luts4"]
    micros = scene.twin().output_clocks[-1] / scene.clock_mhz
    return [
        *body,
        line([(x + 14, y + 144), (x + width - 14, y + 144)], stroke=FAINT),
        text((x + 16, y + 164), f"{cells['LUT']} LUTs: {share:.1%} of it".replace("%", " %"), 14),
        text((x + 16, y + 181), f"an answer in {micros:.1f} µs", 14),
        *_captioned(
            x, f"{len(shapes)} networks on a chip", "plain VHDL, proved", "for every frame"
        ),
    ]


def _curve(scene: Scene, frame: int) -> list[str]:
    """The load along the beam that the outputs of a recorded frame say, and the recorded one.

    What the outputs mean is written beside it.
    """
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
    (left, _), (right, high) = recorded[0], recorded[-2]
    middle, beside, above = (left + right) / 2, right + 16, high - 12
    end, level = CHIP[0] + CHIP_SIZE[0], CHIP[1] + 95
    load, position, width, shape = scene.outputs
    return [
        line([(end + 10, level), (CURVE - 16, level)], stroke=FAINT, stroke_width=1.5),
        arrow_head((CURVE - 10, level), (1, 0), FAINT),
        line([(CURVE, GROUND), (CURVE + CURVE_WIDTH, GROUND)], stroke=FAINT),
        line(recorded, stroke=FAINT, stroke_width=1.5, stroke_dasharray="5 4"),
        line(computed, stroke=ACCENT, stroke_width=2.5),
        line([(beside, GROUND - 2), (beside, high)], stroke=INK),
        arrow_head((beside, high), (0, -1), INK),
        text((beside + 8, (GROUND + high) / 2 + 14), load, 14),
        line([(left, above), (right, above)], stroke=INK),
        arrow_head((left, above), (-1, 0), INK),
        arrow_head((right, above), (1, 0), INK),
        text((middle, above - 6), width, 14, text_anchor="middle"),
        text((beside + 8, high + 12), f"{shape}: flat", 14),
        line([(middle, GROUND - 5), (middle, GROUND + 5)], stroke=INK),
        text((middle, GROUND + 20), position, 14, text_anchor="middle"),
        text(
            (CURVE + CURVE_WIDTH, GROUND + 20), "along the beam", 12, text_anchor="end", fill=FAINT
        ),
        *_captioned(CURVE, "what it felt", "computed, and as", "recorded (dashed)"),
    ]


def wishes(
    networks: list[Row],
    named: tuple[str, str],
    clock_mhz: float,
    parts: list[float],
    kept: dict[str, tuple[float, float]],
) -> str:
    """Errors against run time, cases against their bound, and what is kept of a whole scene.

    named: The two of ``networks`` that have their names beside them.
    parts: The figure of each case as a part of its bound.
    kept: For each kind its count as built, and in the whole.
    """
    body = [*_times(networks, named, clock_mhz), *_cases(parts), *_kept(kept)]
    headings = ("error against run time", "numerical stability", "left out")
    for x, heading in zip(LEFT, headings, strict=True):
        body.append(text((x, 20), heading, 15, font_weight="bold"))
    title = "Error against run time; cases against their bound; what is left out"
    return _whole(title, WISHES_SIZE, body)


def _axis(x: float, below: str) -> list[str]:
    return [
        line([(x, BOTTOM), (x + WIDTH, BOTTOM)], stroke=FAINT),
        text((x, BOTTOM + 38), below, 13, fill=FAINT),
    ]


def _times(networks: list[Row], named: tuple[str, str], clock_mhz: float) -> list[str]:
    """Every network of four outputs, by its time in microseconds and its held-out error."""
    x, (least, most) = LEFT[0], MICROS

    def place(micros: float, error: float) -> Point:
        share = log10(micros / least) / log10(most / least)
        return x + WIDTH * share, BOTTOM - (BOTTOM - TOP) * error / ERROR

    body = [*_axis(x, "µs a frame; every design")]
    for micros in (0.1, 1, 10, 100):
        below = (place(micros, 0)[0], BOTTOM + 18)
        body.append(text(below, f"{micros:g}", 13, text_anchor="middle", fill=FAINT))
    for error in (1, 2, 3):
        _, y = place(least, error)
        body.append(line([(x, y), (x + WIDTH, y)], stroke=FAINT, stroke_width=0.4))
        body.append(text((x, y - 3), f"{error} %", 12, fill=FAINT))
    last = []
    for row in networks:
        at = place(cell(row, AFTER) / clock_mhz, cell(row, "held out %"))
        if scene_of(row) in named:
            last.append(dot(at, 5, fill=ACCENT))
            last.append(text((at[0] + 8, at[1] + 4), scene_of(row), 13))
        else:
            body.append(dot(at, 3, fill=FAINT))
    return body + last


def _cases(parts: list[float]) -> list[str]:
    """How many cases reach which part of their bound, in powers of ten."""
    x, step = LEFT[1], WIDTH / -LEAST
    counts = Counter(max(LEAST, ceil(log10(part)) - 1) if part else LEAST for part in parts)
    body = [*_axis(x, f"of its bound; {len(parts)} cases")]
    for power in range(LEAST, 0):
        at = x + step * (power - LEAST)
        tall = (BOTTOM - TOP) * counts[power] / max(counts.values())
        body.append(box((at + 2, BOTTOM - tall), (step - 4, tall), fill=ACCENT, stroke="none"))
    for power in (-5, -3, 0):
        label = f"{100 * 10.0**power:g} %"
        at = x + step * (power - LEAST)
        body.append(text((at, BOTTOM + 18), label, 13, text_anchor="middle", fill=FAINT))
    return [
        *body,
        line([(x + WIDTH, TOP - 8), (x + WIDTH, BOTTOM)], stroke=INK, stroke_dasharray="5 4"),
    ]


def _kept(kept: dict[str, tuple[float, float]]) -> list[str]:
    """A bar for each kind, which is filled as far as the whole is built."""
    x, body = LEFT[2], []
    for n, (kind, (built, whole)) in enumerate(kept.items()):
        y = TOP + 2 + 43 * n
        body += [
            text((x, y + 10), f"{kind}: {built:,.0f} of {whole:,.0f}", 14),
            box((x, y + 16), (WIDTH, 12), stroke=FAINT),
            box((x, y + 16), (WIDTH * built / whole, 12), fill=ACCENT, stroke="none"),
        ]
    return [*body, text((x, BOTTOM + 38), "needed, of the whole", 13, fill=FAINT)]
