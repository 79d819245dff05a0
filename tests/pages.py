"""Compares the figures that a page shows with measured ones, and states how exact this can be.

Another processor rounds last bits differently. On x86-64, eleven settings of the processor and two
versions of SciPy changed sums over recorded vectors and codes, series and converged fits by 2e-7 at
most (docs/studies/numerics.md). ROUNDING is fifty times that, and a tenth of the last digit that
any page shows.
"""

import re
from decimal import Decimal
from html.parser import HTMLParser
from pathlib import Path

DOCS = Path(__file__).parents[1] / "docs"

ROUNDING = 1e-5

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


def shows(text: str, measured: float, bound: float) -> bool:
    """Whether the figure or the range ("3 to 4") that a page shows agrees with the measured one.

    bound: The allowed relative difference of another machine.
    """
    assert FIGURE.fullmatch(text), f"got {text!r}, expected a number, or two with 'to' between"
    ends = [Decimal(end.replace(",", "")) for end in text.split(" to ")]
    low, high = (float(end) for end in (ends[0], ends[-1]))
    # Half a unit of the last digit that is written.
    below, above = (0.5 * 10.0 ** int(end.as_tuple().exponent) for end in (ends[0], ends[-1]))
    slack = bound * abs(measured)
    return low - below - slack <= measured <= high + above + slack


class HtmlPage(HTMLParser):
    """Every anchor of a page, and everything that it loads or links to."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors: list[str] = []
        self.links: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name == "id" or (name == "name" and tag == "a"):
                self.anchors.append(value or "")
            elif name in ("src", "href", "xlink:href", "data", "srcset") and value:
                self.links.append(value)
