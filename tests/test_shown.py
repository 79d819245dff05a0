"""Tests that the comparison of pages with measurements finds wrong figures, and only those."""

import pytest
from pages import ROUNDING, SEARCHED, cells, shows

PAGE = """
| method | error | work |
|---|---|---|
| fast | 1.50 | 3490, 96 |
| slow | 2 to 3 | |

    exact   float   0.25
"""


def test_a_line_is_found_by_what_it_begins_with() -> None:
    assert cells(PAGE, "fast") == ["1.50", "3490, 96"]
    assert cells(PAGE, "slow") == ["2 to 3", ""]
    assert cells(PAGE, "exact", "float") == ["0.25"]
    for start in ("quick", ""):
        with pytest.raises(
            AssertionError, match=f"lines begin with \\('{start}',\\), expected one"
        ):
            cells(PAGE, start)


@pytest.mark.parametrize("bound", [ROUNDING, SEARCHED])
@pytest.mark.parametrize(
    ("text", "digits"), [("1.04", None), ("-12.5", None), ("1.70e-3", None), ("11,200", 3)]
)
def test_a_figure_ten_percent_off_is_found_out(text: str, digits, bound: float) -> None:
    right = float(text.replace(",", ""))
    for factor in (1 - 0.9 * bound, 1, 1 + 0.9 * bound):
        assert shows(text, factor * right, bound, digits)
    for factor in (0.9, 1.1):
        assert not shows(text, factor * right, bound, digits)


def test_half_a_unit_of_the_last_digit_is_what_a_page_leaves_open() -> None:
    assert shows("0.1", 0.1499, 0)
    assert not shows("0.1", 0.1501, 0)
    assert shows("3490", 3494, 0, 3)
    assert not shows("3490", 3494, 0)


def test_a_range_holds_what_lies_between_its_ends() -> None:
    for measured in (1.95, 2.5, 3.04):
        assert shows("2.0 to 3.0", measured, 0)
    for measured in (1.94, 3.06, -2.5):
        assert not shows("2.0 to 3.0", measured, 0)


@pytest.mark.parametrize("text", ["", "about 3", "3 or 4", "3.0 %"])
def test_what_is_no_figure_is_refused(text: str) -> None:
    with pytest.raises(AssertionError, match="expected a number, or two"):
        shows(text, 3.0, ROUNDING)
