"""Tests table word_widths: the content of the record."""

from tactus.report.measure.word_widths import COLUMNS, KEY, SCENES, pairs, row, word_widths
from tactus.scene import load_scene


def test_there_is_a_row_for_every_width_and_every_scene_that_has_one() -> None:
    table = word_widths(1)
    assert list(table.columns) == COLUMNS
    assert [(found[0], found[3]) for found in table.rows] == pairs()
    for name in SCENES:
        shipped = load_scene(name).design_options[KEY]
        (own,) = (found for found in table.rows if found[0] == name and found[5] is not None)
        assert own[3] == shipped


def test_a_row_is_what_is_measured() -> None:
    """A row that takes little: a whole matrix of the digits takes long to find."""
    number = 4
    name, width = pairs()[number]
    assert row(name, width) == list(word_widths(1).rows[number])
