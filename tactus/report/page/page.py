"""The report as one HTML file that needs no other files."""

from collections.abc import Sequence
from dataclasses import dataclass

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined, select_autoescape

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
        return environment("tactus.report.page").get_template("page.html.jinja").render(page=self)


def environment(package: str) -> Environment:
    """An environment for the templates of a package, which may include those of this package."""
    found = Environment(
        loader=ChoiceLoader([PackageLoader(name, ".") for name in (package, "tactus.report.page")]),
        autoescape=select_autoescape(["jinja"]),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    return found
