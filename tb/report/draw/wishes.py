"""Draws what tactus was asked to show, for the first screen: a small picture for each wish."""

from collections import Counter
from math import ceil, log10

from tb.report.draw.drawing import Point, box, dot, line, number, text
from tb.report.draw.findings import Row
from tb.report.draw.findings import number as cell
from tb.report.draw.overview import ACCENT, FAINT, INK, STYLE
from tb.report.draw.run_time import AFTER, scene_of
from tb.report.measure.stability.margins import Case

SIZE = (680.0, 216.0)
# Left edges and width of the three pictures, and where their areas begin and end.
LEFT, WIDTH, TOP, GROUND = (10.0, 250.0, 490.0), 180.0, 46.0, 172.0
# The longest time and the largest error of the first picture, and the least part of the second.
MICROS, ERROR, LEAST = (0.05, 100.0), 3.0, -6


def wishes(
    networks: list[Row],
    named: tuple[str, str],
    clock_mhz: float,
    found: list[Case],
    kept: dict[str, tuple[float, float]],
) -> str:
    """Errors against run time, cases against their bound, and what is kept of a whole scene.

    named: The two of ``networks`` that have their names beside them.
    kept: For each kind its count as built, and in the whole.
    """
    body = [*_times(networks, named, clock_mhz), *_cases(found), *_kept(kept)]
    headings = ("error against run time", "numerical stability", "left out")
    for x, heading in zip(LEFT, headings, strict=True):
        body.append(text((x, 20), heading, 15, font_weight="bold"))
    width, height = (number(value) for value in SIZE)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img" '
        f'font-family="sans-serif" fill="{INK}"><title>Error against run time; cases against '
        f"their bound; what is left out</title>{STYLE}{''.join(body)}</svg>\n"
    )


def _axis(x: float, below: str) -> list[str]:
    return [
        line([(x, GROUND), (x + WIDTH, GROUND)], stroke=FAINT),
        text((x, GROUND + 38), below, 13, fill=FAINT),
    ]


def _times(networks: list[Row], named: tuple[str, str], clock_mhz: float) -> list[str]:
    """Every network of four outputs, by its time in microseconds and its held-out error."""
    x, (least, most) = LEFT[0], MICROS

    def place(micros: float, error: float) -> Point:
        share = log10(micros / least) / log10(most / least)
        return x + WIDTH * share, GROUND - (GROUND - TOP) * error / ERROR

    body = [*_axis(x, "µs a frame; every design")]
    for micros in (0.1, 1, 10, 100):
        below = (place(micros, 0)[0], GROUND + 18)
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


def _cases(found: list[Case]) -> list[str]:
    """How many cases reach which part of their bound, in powers of ten."""
    x, step = LEFT[1], WIDTH / -LEAST
    parts = [case.part for case in found if case.part is not None]
    counts = Counter(max(LEAST, ceil(log10(part)) - 1) if part else LEAST for part in parts)
    body = [*_axis(x, f"of its bound; {len(parts)} cases")]
    for power in range(LEAST, 0):
        at = x + step * (power - LEAST)
        tall = (GROUND - TOP) * counts[power] / max(counts.values())
        body.append(box((at + 2, GROUND - tall), (step - 4, tall), fill=ACCENT, stroke="none"))
    for power in (-5, -3, 0):
        label = f"{100 * 10.0**power:g} %"
        at = x + step * (power - LEAST)
        body.append(text((at, GROUND + 18), label, 13, text_anchor="middle", fill=FAINT))
    return [
        *body,
        line([(x + WIDTH, TOP - 8), (x + WIDTH, GROUND)], stroke=INK, stroke_dasharray="5 4"),
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
    return [*body, text((x, GROUND + 38), "needed, of the whole", 13, fill=FAINT)]
