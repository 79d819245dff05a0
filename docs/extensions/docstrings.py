"""Docstrings as reStructuredText: ``name: meaning`` becomes a field of a list."""

import re
from typing import Any

from sphinx.application import Sphinx

FIELD = re.compile(r"((?:Returns|Warns with|[*a-z_])[^:]*): (?=\S)")


def mark_fields(
    app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]
) -> None:
    """Change the paragraphs whose first lines all begin with names."""
    start = 0
    for end in range(len(lines) + 1):
        if end < len(lines) and lines[end].strip():
            continue
        first = [n for n in range(start, end) if not lines[n].startswith(" ")]
        if first and first[0] == start and all(FIELD.match(lines[n]) for n in first):
            for n in first:
                lines[n] = FIELD.sub(lambda found: f":{found[1].replace('*', '')}: ", lines[n], 1)
        start = end + 1


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("autodoc-process-docstring", mark_fields)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
