"""Makes SVG that can share a page with other SVG, and has the same bytes on every run; pictures."""

import io
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from html import escape
from typing import Any

import matplotlib
from matplotlib.figure import Figure
from matplotlib.rcsetup import cycler

# The margins of the page at the left and right of a picture, in CSS pixels.
MARGINS = 32
# The page is at most 72 rem wide, even in a wider window.
WIDEST, ANY = 72 * 16, 1e5


@dataclass(frozen=True)
class Picture:
    """A drawing with a sentence below it.

    name: The file name without its suffix.
    svg: An ``<svg>`` element.
    sentence: Says what the drawing shows, or what its figures support.
    wide: Whether the drawing takes the whole width of a desktop. On a phone it scrolls sideways.
    """

    name: str
    title: str
    svg: str
    sentence: str
    wide: bool = False

    @property
    def scrolls_below(self) -> float:
        """The width of a window, in CSS pixels, below which the picture scrolls; 0 for never."""
        found = re.search(r"min-width:([\d.]+)px", self.svg) if self.wide else None
        if found is None:
            return 0.0
        least = float(found[1]) + MARGINS
        return least if least <= WIDEST else ANY


# A phone shows this width without shrinking the letters, and a desktop two side by side.
PLOT_INCHES = (4.6, 3.4)
_STYLE: dict[Any, Any] = {
    # Without a salt the ids are random. Letters are kept as text, so that a reader can search them.
    "svg.hashsalt": "tactus",
    "svg.fonttype": "none",
    "font.family": "sans-serif",
    # Every element names all families.
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 10,
    "axes.grid": True,
    "grid.linewidth": 0.3,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "lines.linewidth": 1.2,
    "lines.markersize": 4,
}
# An id of matplotlib: a letter for the kind, and a digest of the content.
_MADE = re.compile(r'(?<=id=")[a-z][0-9a-f]{10}(?=")')


@contextmanager
def style() -> Iterator[None]:
    """The settings of matplotlib for every plot of the report."""
    with matplotlib.rc_context(_STYLE):
        yield


def plain(name: str) -> str:
    """A user's name as a label: no part is read as mathematics, and every legend shows it."""
    text = name.replace("$", r"\$")
    return f" {text}" if text.startswith("_") else text


def svg(figure: Figure, name: str, title: str, narrowest: float = 0, tight: bool = False) -> str:
    """A matplotlib figure as one ``<svg>`` element.

    name: The prefix of every id, so that no two pictures of a page share an id. It has letters,
        digits and ``_``.
    title: For readers who do not see the figure.
    narrowest: In CSS pixels. On a page narrower than this it scrolls sideways.
    tight: Whether it is as large as what is drawn, and not as the figure.
    """
    buffer, box = io.StringIO(), "tight" if tight else None
    about = {"Date": None, "Creator": None}
    with style():
        figure.savefig(buffer, format="svg", metadata=about, bbox_inches=box)
    text = own_ids(buffer.getvalue().partition("<svg")[2], name)
    # Two decimals are a hundredth of a point. The six of matplotlib make a page large.
    text = re.sub(r'(?<= d=")[^"]+', lambda way: re.sub(r"(\.\d\d)\d+", r"\1", way[0]), text)
    head, _, body = text.partition(">")
    least = f"min-width:{narrowest:g}px;" if narrowest else ""
    fitting = f'role="img" style="display:block;max-width:100%;{least}height:auto"'
    return f"<svg{head} {fitting}><title>{escape(title)}</title>{body}"


def own_ids(text: str, name: str) -> str:
    """Put ``name`` before every id of an SVG and before every reference to one.

    matplotlib makes ids from the last bits of coordinates, which depend on the processor. These ids
    are replaced by numbers.
    """
    for n, made in enumerate(dict.fromkeys(_MADE.findall(text))):
        text = text.replace(made, f"{made[0]}{n}")
    text = re.sub(r'\bid="', f'id="{name}-', text)
    text = re.sub(r"url\(#", f"url(#{name}-", text)
    return re.sub(r'href="#', f'href="#{name}-', text)


INK, FAINT, ACCENT = "#111111", "#999999", "#1f5fa8"
# The looks of the groups of a plot.
GROUPS = cycler(
    color=(
        *("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9"),
        *("#e69f00", "#000000", "#999999", "#8c510a", "#762a83"),
    ),
    marker=("o", "s", "^", "D", "v", "P", "X", "d", "<", ">"),
)
