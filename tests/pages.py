"""Compares the figures that a page shows with measured ones, and states how exact this can be.

Another processor rounds last bits differently, and other versions of SciPy take other steps. The
relative change of figures was measured on x86-64 with eleven settings of the processor, and with
SciPy 1.13 and 1.17 (docs/studies/numerics.md):

========= ====================================================================== ================
bound     figures                                                                differed by
========= ====================================================================== ================
ROUNDING  sums over recorded vectors and codes, series, converged fits           2e-7 at most
SEARCHED  evaluations of integrators that choose their steps (3.3 %); errors of  3.4 % at most
          smooth networks that were trained for the table (3.4 %)
========= ====================================================================== ================

The first bound is fifty times the largest measured change, and a tenth of the last digit that any
page shows. The second bound is one and a half times the largest change. So the test finds a figure
of three digits that is ten percent off, and a figure of another row.
"""

import re
from decimal import Decimal
from pathlib import Path

DOCS = Path(__file__).parents[1] / "docs"

ROUNDING, SEARCHED = 1e-5, 0.05

NUMBER = r"-?\d[\d,]*(?:\.\d+)?(?:e-?\d+)?"
FIGURE = re.compile(rf"{NUMBER}(?: to {NUMBER})?")


# A difference in points, for the width of a picture, that nobody can see.
UNSEEN = 0.01


def same_picture(one: str, other: str) -> bool:
    """Whether two SVG differ only in coordinates, by so little that nobody can see it.

    Other versions of matplotlib draw other paths; the title of what it draws holds every figure.
    """
    if "-figure_1" in one:
        words = r"<(title|text)[^>]*>([^<]*)"
        return re.findall(words, one) == re.findall(words, other)
    number = r"-?\d+(?:\.\d+)?"
    if re.sub(number, "0", one) != re.sub(number, "0", other):
        return False
    pairs = zip(re.findall(number, one), re.findall(number, other), strict=True)
    return all(a == b or abs(float(a) - float(b)) <= UNSEEN for a, b in pairs)


def section(page: str, heading: str) -> str:
    """The text of a page of ``docs`` below a heading."""
    text = (DOCS / f"{page}.md").read_text(encoding="utf-8")
    _, found, below = text.partition(f"\n## {heading}\n")
    assert found, f"{page}.md has no heading {heading!r}"
    return below.partition("\n## ")[0]


def cells(page: str, *start: str) -> list[str]:
    """The other cells of the one line of a table or text that begins with ``start``."""
    found = []
    for line in page.splitlines():
        words = line[1:].rstrip().removesuffix("|").split("|") if line[:1] == "|" else line.split()
        words = [word.strip() for word in words]
        if words[: len(start)] == list(start):
            found.append(words[len(start) :])
    assert len(found) == 1, f"{len(found)} lines begin with {start}, expected one"
    return found[0]


def shows(text: str, measured: float, bound: float, digits: int | None = None) -> bool:
    """Whether the figure or the range ("3 to 4") that a page shows agrees with the measured one.

    bound: The allowed relative difference of another machine, which is one of the bounds above.
    digits: To how many digits the page rounds. The default is the last digit that is written.
    """
    assert FIGURE.fullmatch(text), f"got {text!r}, expected a number, or two with 'to' between"
    ends = text.split(" to ")
    low, high = (Decimal(end.replace(",", "")) for end in (ends[0], ends[-1]))
    slack = bound * abs(measured)
    return (
        float(low) - half_a_unit(low, digits) - slack
        <= measured
        <= float(high) + half_a_unit(high, digits) + slack
    )


def half_a_unit(figure: Decimal, digits: int | None) -> float:
    """Half a unit of the last digit of a figure."""
    last = figure.as_tuple().exponent if digits is None else figure.adjusted() + 1 - digits
    return 0.5 * 10.0 ** int(last)
