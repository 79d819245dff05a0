"""Makes matplotlib's figures as accessible and as wide as the other pictures."""

import re
from html import escape

from matplotlib.figure import Figure

from tactus.report.draw.svg import svg


def plotted(figure: Figure, name: str, title: str) -> str:
    """A figure as one ``<svg>`` element, with a title for readers who do not see it.

    name: See ``tactus.report.draw.svg.svg``.
    """
    # Two decimals are a hundredth of a point. The six of matplotlib make a page large.
    text = re.sub(r'(?<= d=")[^"]+', _shortened, svg(figure, name))
    end = text.index(">")
    fitting = 'role="img" style="display:block;max-width:100%;height:auto"'
    return f"{text[:end]} {fitting}><title>{escape(title)}</title>{text[end + 1 :]}"


def _shortened(way: re.Match[str]) -> str:
    return re.sub(r"(\.\d\d)\d+", r"\1", way[0])
