"""The report as one HTML file that needs no other files."""

from collections.abc import Sequence
from dataclasses import dataclass

from tactus.core.templates import environment
from tactus.report.draw.svg import Picture
from tactus.report.measure.table import Table


@dataclass(frozen=True)
class Section:
    """A part of the page.

    name: The name of the anchor.
    text, points: The paragraphs, and the list below them.
    tables: The tables that are shown in full.
    folded: The tables that are shown when the reader opens them, and in print.
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

    built: The lines that say what was built.
    errors, costs: The tables of the first screen.
    made: The lines that say with which tools the report was made.
    """

    title: str
    built: Sequence[str]
    errors: Table
    costs: Table
    sections: Sequence[Section]
    made: Sequence[str] = ()

    def render(self) -> str:
        """The page as HTML."""
        templates = environment("tactus.report.page", escapes=True)
        return templates.get_template("page.html.jinja").render(page=self)
