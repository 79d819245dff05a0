"""What commands write into the pages stands there, and the rest of a page is left alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from golden.cli import CommandError
from tb.report.page.markers import END, begin, put

PAGE = Path("page.md")
COMMAND = "python -m this"


def test_text_goes_between_its_own_markers() -> None:
    one, two = begin(COMMAND), begin(COMMAND, "second")
    page = f"# Page\n{one}\nold\n{END}\nbetween\n{two}\n{END}\nend\n"
    once = put(PAGE, page, "a", COMMAND)
    assert once == f"# Page\n{one}\n\na\n\n{END}\nbetween\n{two}\n{END}\nend\n"
    twice = put(PAGE, once, "b", COMMAND, "second")
    assert twice == f"# Page\n{one}\n\na\n\n{END}\nbetween\n{two}\n\nb\n\n{END}\nend\n"


@pytest.mark.parametrize(
    "page",
    [
        "# Page\n",
        f"{begin(COMMAND)}\n",
        f"{END}\n{begin(COMMAND)}\n",
        f"{begin(COMMAND)}\n{END}\n" * 2,
        f"{begin(COMMAND, 'another')}\n{END}\n",
    ],
)
def test_a_page_without_its_markers_once_each_is_refused(page: str) -> None:
    with pytest.raises(CommandError, match=r"page\.md: expected the markers"):
        put(PAGE, page, "text", COMMAND)
