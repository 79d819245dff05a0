"""The few SVG elements that the pictures are drawn with.

Diagrams are not drawn with matplotlib, as plots are, for two reasons. SVG has what a plot does not
have: boxes that share a size, tooltips, links and animations. And the bytes of such a picture do
not depend on the version of a library, so a test can compare the pictures of pages with new ones.
"""

from collections.abc import Iterable, Sequence
from html import escape

# The width of a letter at size 1, wide enough for the usual sans-serif fonts.
LETTER = 0.6
INK, FAINT, ACCENT = "#111", "#999", "#1f5fa8"
SIZE = 11.0

Point = tuple[float, float]


def number(value: float) -> str:
    """A coordinate with two decimals, or with none if they are 0."""
    return f"{value:.2f}".rstrip("0").rstrip(".")


def text_width(words: str, size: float = SIZE) -> float:
    """The approximate width of ``words``."""
    return LETTER * size * len(words)


def attributes(**values: str | float) -> str:
    """Attributes with a blank before each. ``_`` stands for ``-``, and empty ones are left out."""
    return "".join(
        f' {name.rstrip("_").replace("_", "-")}="'
        f'{escape(value) if isinstance(value, str) else number(value)}"'
        for name, value in values.items()
        if value != ""
    )


def text(at: Point, words: str, size: float = SIZE, **values: str | float) -> str:
    """A text whose baseline starts at ``at``."""
    x, y = at
    return f"<text{attributes(x=x, y=y, font_size=size, **values)}>{escape(words)}</text>"


def line(points: Sequence[Point], **values: str | float) -> str:
    """A line through ``points``."""
    way = "L".join(f"{number(x)} {number(y)}" for x, y in points)
    return f"<path{attributes(d=f'M{way}', fill='none', **({'stroke': INK} | values))}/>"


def box(at: Point, size: Point, **values: str | float) -> str:
    """A rectangle without a fill, whose upper left corner is ``at``."""
    x, y = at
    width, height = size
    given = {"fill": "none", "stroke": INK} | values
    return f"<rect{attributes(x=x, y=y, width=width, height=height, **given)}/>"


def dot(at: Point, radius: float, **values: str | float) -> str:
    """A disc."""
    return f"<circle{attributes(cx=at[0], cy=at[1], r=radius, **({'fill': INK} | values))}/>"


def arrow_head(at: Point, direction: Point, colour: str = INK) -> str:
    """A triangle with its tip at ``at``. ``direction`` is one of the four along the axes."""
    (x, y), (dx, dy) = at, direction
    corners = [
        (x, y),
        (x - 6 * dx - 3 * dy, y - 6 * dy - 3 * dx),
        (x - 6 * dx + 3 * dy, y - 6 * dy + 3 * dx),
    ]
    way = "L".join(f"{number(a)} {number(b)}" for a, b in corners)
    return f"<path{attributes(d=f'M{way}Z', fill=colour)}/>"


def group(body: Iterable[str], title: str = "", **values: str | float) -> str:
    """A group of elements. A pointer that rests on them shows ``title``."""
    told = f"<title>{escape(title)}</title>" if title else ""
    return f"<g{attributes(**values)}>{told}{''.join(body)}</g>"


def picture(
    title: str,
    size: Point,
    body: Iterable[str],
    narrowest: float = 0,
    widest: float = 560,
) -> str:
    """One ``<svg>`` element, black on white, as wide as its place in the page.

    title: The description for readers who do not see the picture.
    size: The width and height of the area that the coordinates of ``body`` use.
    body: Elements without ids, because a page may show pictures of several scenes.
    narrowest, widest: The width in CSS pixels. On a page narrower than ``narrowest`` it scrolls
        sideways.
    """
    width, height = (number(value) for value in size)
    least = f"min-width:{number(narrowest)}px;" if narrowest else ""
    # A printed page cannot be scrolled.
    paper = "<style>@media print{svg{min-width:0!important}}</style>" if narrowest else ""
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img" '
        f'style="display:block;width:100%;{least}max-width:{number(widest)}px;height:auto" '
        f'font-family="sans-serif" fill="{INK}"><title>{escape(title)}</title>{paper}'
        f'<rect width="{width}" height="{height}" fill="#fff"/>{"".join(body)}</svg>\n'
    )
