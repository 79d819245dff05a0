"""Draws every stiff and extreme case as a disc, at the part of its bound that it reaches."""

from math import log10

from tactus.report.draw.drawing import ACCENT, FAINT, dot, line, picture, text
from tactus.report.measure.stability.margins import Case, cases
from tactus.report.measure.table import Table

WIDTH, TOP, ROW = 560.0, 84.0, 15.0
# From left to right: names, cases that must count 0, cases far below their bound, the log axis.
NAMES, ZERO, LEFT, RIGHT = 6.0, 164.0, 228.0, 536.0
LEAST = 1e-6
REACHED = "#b34700"


def margins(table: Table) -> str:
    """The picture of table ``stability``, with a line for each model."""
    found = cases(table)
    models = list(dict.fromkeys(case.label for case in found))
    bottom = TOP + ROW * len(models)
    holding = sum(case.holds for case in found)
    title = f"{holding} of {len(found)} cases keep their bound"
    body = [
        text((6, 18), title, 13, font_weight="bold"),
        text(
            (6, 36),
            "number: cases that count what must not happen; disc: a case with a bound above",
        ),
        text(
            (6, 51),
            "0, its figure as a part of the bound; 1 is the bound, less: a millionth or less",
        ),
        text((ZERO, TOP - 12), "must be 0", text_anchor="middle"),
    ]
    for power in range(round(log10(LEAST)), 1):
        x = _at(10.0**power)
        colour = REACHED if power == 0 else FAINT
        body.append(line([(x, TOP - 6), (x, bottom)], stroke=colour, stroke_width=0.6))
        label = "less" if power == round(log10(LEAST)) else f"{10.0**power:g}"
        body.append(text((x, TOP - 12), label, text_anchor="middle"))
    for n, model in enumerate(models):
        y = TOP + ROW * (n + 0.5)
        body.append(text((NAMES, y + 4), model))
        body.append(line([(LEFT, y), (RIGHT, y)], stroke=FAINT, stroke_width=0.2))
        body += _line(y, [case for case in found if case.label == model])
    body.append(text((6, bottom + 18), "orange: comes to its bound, and must; see the page"))
    return picture(f"{title}. {sentence(found)}", (WIDTH, bottom + 28), body, widest=640)


def sentence(found: list[Case]) -> str:
    """The description for readers who do not see the picture."""
    free = [case for case in found if case.part is not None and not case.reached]
    worst = max(free, key=lambda case: case.part or 0.0)
    return (
        f"Of those that need not come to their bound, {worst.label}, {worst.case}, is nearest: "
        f"{worst.part:.2g} of it."
    )


def _line(y: float, alike: list[Case]) -> list[str]:
    exact = sum(case.part is None for case in alike)
    drawn = [text((ZERO, y + 4), str(exact), text_anchor="middle")] if exact else []
    places = {(round(_at(c.part), 1), c.reached) for c in alike if c.part is not None}
    for x, reached in sorted(places):
        colour = REACHED if reached else ACCENT
        drawn.append(dot((x, y), 3.5, fill=colour, fill_opacity=0.6, stroke=colour))
    return drawn


def _at(part: float) -> float:
    return LEFT + (RIGHT - LEFT) * (1 - log10(max(min(part, 1.0), LEAST)) / log10(LEAST))
