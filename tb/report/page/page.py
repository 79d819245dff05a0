"""The report as one HTML file that needs nothing beside it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined, select_autoescape

from tb.report.measure.table import Cell, Table, shown

# What the page leaves free at the left and at the right of a picture, in CSS pixels.
MARGINS = 32
# The page is no wider than 72 rem, however wide the window is.
WIDEST, ANY = 72 * 16, 1e5


@dataclass(frozen=True)
class Picture:
    """A drawing with the sentence under it.

    Parameters
    ----------
    name : str
        File name without suffix.
    title : str
    svg : str
        An ``<svg>`` element.
    sentence : str
        What it shows, or what its figures support.
    wide : bool
        Takes the whole width of a desktop; on a phone it scrolls sideways.
    """

    name: str
    title: str
    svg: str
    sentence: str
    wide: bool = False

    @property
    def scrolls_below(self) -> float:
        """Width of a window, in CSS pixels, below which the picture has to be scrolled; 0: none."""
        found = re.search(r"min-width:([\d.]+)px", self.svg) if self.wide else None
        if found is None:
            return 0.0
        least = float(found[1]) + MARGINS
        return least if least <= WIDEST else ANY


@dataclass(frozen=True)
class Section:
    """A part of the page.

    Parameters
    ----------
    name : str
        The anchor.
    title : str
    text, points : sequence of str
        Paragraphs, and below them a list.
    pictures : sequence of Picture
    tables : sequence of Table
        Shown in full.
    folded : sequence of Table
        Shown when the reader opens them, and in print.
    """

    name: str
    title: str
    text: Sequence[str] = ()
    points: Sequence[str] = ()
    pictures: Sequence[Picture] = ()
    tables: Sequence[Table] = ()
    folded: Sequence[Table] = ()


@dataclass(frozen=True)
class Page:
    """The whole report.

    Parameters
    ----------
    title : str
    built : sequence of str
        What was built, a line each.
    errors, costs : Table
        The first screen's tables.
    sections : sequence of Section
    made : sequence of str
        With what it was made, a line each.
    """

    title: str
    built: Sequence[str]
    errors: Table
    costs: Table
    sections: Sequence[Section]
    made: Sequence[str] = ()

    def render(self) -> str:
        """The page as HTML."""
        return environment("tb.report.page").get_template("page.html.jinja").render(page=self)


def environment(package: str) -> Environment:
    """What renders the templates of a package, which may include those of this one."""
    found = Environment(
        loader=ChoiceLoader([PackageLoader(name, ".") for name in (package, "tb.report.page")]),
        autoescape=select_autoescape(["jinja"]),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    found.filters["shown"] = _cell
    return found


def _cell(cell: Cell) -> str:
    """As in print, with whole numbers in groups of three digits."""
    return f"{cell:,}" if isinstance(cell, int) else shown(cell)
