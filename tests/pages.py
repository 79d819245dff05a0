"""What a page shows against what was measured: one comparison, and how exact it can be.

Another processor rounds last bits otherwise, and other versions of SciPy take other steps. What
that does to a figure, as a part of it, was measured by ``python -m tb.report.measure.spread
figures`` on x86-64 with every setting named there, and with SciPy 1.13 and 1.17:

========= ====================================================================== ================
bound     figures                                                                differed by
========= ====================================================================== ================
ROUNDING  sums over recorded vectors and codes, series, converged fits           2e-7 at most
SEARCHED  evaluations of integrators that choose their steps (3.3 %); errors of  3.4 % at most
          smooth networks that were trained for the table (3.4 %)
TRAINED   the ends of descents that a last bit turns to another minimum: a page  their range is
          shows their range, so this is what may lie beyond either end of it     on the page
========= ====================================================================== ================

The first bound is fifty times what was seen and a tenth of the last digit that any page shows, the
second half as much again. So a figure of three digits that is ten percent off is found out, and so
is one of another row.
"""

from __future__ import annotations

import re
from decimal import Decimal
from pathlib import Path

DOCS = Path(__file__).parents[1] / "docs"

ROUNDING, SEARCHED, TRAINED = 1e-5, 0.05, 0.25

NUMBER = r"-?\d[\d,]*(?:\.\d+)?(?:e-?\d+)?"
FIGURE = re.compile(rf"{NUMBER}(?: to {NUMBER})?")


# Of the width of a picture in points: what nobody sees.
UNSEEN = 0.01


def same_picture(one: str, other: str) -> bool:
    """Whether two SVG differ in nothing but coordinates, and in these by what nobody sees."""
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
    """The further cells of the one line that begins with these: of a table, or of printed words."""
    found = []
    for line in page.splitlines():
        words = line[1:].rstrip().removesuffix("|").split("|") if line[:1] == "|" else line.split()
        words = [word.strip() for word in words]
        if words[: len(start)] == list(start):
            found.append(words[len(start) :])
    assert len(found) == 1, f"{len(found)} lines begin with {start}, expected one"
    return found[0]


def shows(text: str, measured: float, bound: float, digits: int | None = None) -> bool:
    """Whether the figure or the range ("3 to 4") that a page shows is what was measured.

    Parameters
    ----------
    text : str
    measured : float
    bound : float
        What another machine may measure, as a part of the figure: one of those above.
    digits : int
        To how many digits the page rounds; to the last one that is written, where not given.
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
    """Half of what one is worth in the last digit of a figure."""
    last = figure.as_tuple().exponent if digits is None else figure.adjusted() + 1 - digits
    return 0.5 * 10.0 ** int(last)
