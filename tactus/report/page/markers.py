"""Replaces generated text between two markers of a page. The rest of a page is written by hand."""

from collections.abc import Mapping
from pathlib import Path

from golden.input_error import InputError
from tactus.core.files import replace_file
from tactus.core.fingerprint import ROOT

END = "<!-- to here -->"


def begin(command: str, section: str = "") -> str:
    """The first marker, which names the command that writes the text, and the section."""
    return f"<!-- {section and section + ', '}from here: {command} -->"


def put(page: Path, old: str, text: str, command: str, section: str = "") -> str:
    """The page's text ``old`` with ``text`` between its markers.

    page: The page, which the message names.
    command, section: See ``begin``.
    """
    first = begin(command, section)
    head, _, rest = old.partition(first)
    if old.count(first) != 1 or END not in rest:
        raise InputError(f"{page}: expected the markers {first} and {END} once each")
    return f"{head}{first}\n\n{text}\n\n{END}{rest.partition(END)[2]}"


def write(pages: Mapping[Path, str]) -> None:
    """Write the pages that differ or do not exist, and say which."""
    for page, text in pages.items():
        if not page.exists() or page.read_text(encoding="utf-8") != text:
            with replace_file(page) as temporary:
                temporary.write_text(text, encoding="utf-8")
            print(f"wrote {page.relative_to(ROOT)}")
