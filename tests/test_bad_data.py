"""Invalid recorded vectors are refused by one line with file, line and column."""

import pytest
from refused import Desk

HEADER = b"x0,x1,x2,y0,y1\n"
LINES = b"0.1,0.2,0.3,0.4,0.5\n" * 3

# Contents of mine.csv, and the message for each.
TABLE = {
    "empty": (b"", "mine.csv: got 0 lines, expected a header and at least one row"),
    "blank lines": (b"\n\n\n", "mine.csv: got 0 lines, expected a header"),
    "a header alone": (HEADER, "mine.csv: got 1 lines, expected a header and at least one row"),
    "no header": (LINES, "mine.csv: the first line holds numbers, expected the names"),
    "latin": (HEADER + b"1,2,3,4,\xe9\n", "mine.csv:2: got byte 0xe9, expected UTF-8; save it as"),
    "utf-16": (
        HEADER.decode().encode("utf-16"),
        "mine.csv: got UTF-16, expected UTF-8; save it as",
    ),
    "an image": (b"\x89PNG\r\n\x1a\n" + bytes(99), "mine.csv:1: got byte 0x89, expected UTF-8"),
    "compressed": (
        b"\x1f\x8b\x08" + bytes(range(99)),
        "mine.csv:1: got byte 0x8b, expected UTF-8",
    ),
    "zeros": (bytes(1000), "mine.csv: got 1 lines, expected a header and at least one row"),
    "a zero": (HEADER + b"0.1,0.2,0.3,0.4,\x000.5\n", r"mine.csv:2: column 'y1': got '\x000.5'"),
    "semicolons": (
        (HEADER + LINES).replace(b",", b";"),
        "mine.csv: got a semicolon between the cells, expected",
    ),
    "tabulators": (
        (HEADER + LINES).replace(b",", b"\t"),
        "mine.csv: got a tab between the cells, expected a",
    ),
    "decimal commas": (HEADER + LINES.replace(b".", b","), "mine.csv:2: got 10 cells, expected 5"),
    "a cell too long": (HEADER + b"1" * 200_000 + b",1,1,1,1\n", "mine.csv: not CSV: field larger"),
    "a quote that never ends": (HEADER + b'"' + b"a\n" * 99_999, "mine.csv: not CSV: field larger"),
    "a quote over a line": (
        HEADER + b'"0.1,0.2\n0.3",0.5\n',
        "mine.csv:3: got 2 cells, expected 5",
    ),
    "a column twice": (
        b"x0,x0,x2,y0,y1\n" + LINES,
        "mine.csv: column 'x0' stands twice in",
    ),
    "another column": (b"x0,x1,x3,y0,y1\n" + LINES, "mine.csv: no column 'x2', got x0, x1, x3, y0"),
    "capitals": (HEADER.upper() + LINES, "mine.csv: no column 'x0', got X0, X1, X2, Y0, Y1"),
    "a row too short": (HEADER + LINES + b"0.1,0.2\n", "mine.csv:5: got 2 cells, expected 5"),
    "a row too long": (HEADER + b"1,1,1,1,1,1\n", "mine.csv:2: got 6 cells, expected 5"),
    "a word": (HEADER + b"0.1,b,0.3,0.4,0.5\n", "mine.csv:2: column 'x1': got 'b', expected a num"),
    "a blank": (
        HEADER + b"0.1,,0.3,0.4,0.5\n",
        "mine.csv:2: column 'x1': got an empty cell, exp",
    ),
    "NaN": (HEADER + b"0.1,nan,0.3,0.4,0.5\n", "mine.csv:2: column 'x1': got 'nan', expected a f"),
    "infinity": (
        HEADER + b"0.1,0.2,1e999,0.4,0.5\n",
        "mine.csv:2: column 'x2': got '1e999', expe",
    ),
    "hexadecimal": (HEADER + b"0x1,0.2,0.3,0.4,0.5\n", "mine.csv:2: column 'x0': got '0x1', expe"),
    "an underscore": (HEADER + b"0.1,0.2,0.3,0.4,0_5\n", "mine.csv:2: column 'y1': got '0_5', exp"),
    "other digits": (HEADER + "0.1,0.2,0.3,0.4,\u0665\n".encode(), "mine.csv:2: column 'y1': got"),
    "in percent": (HEADER + b"0.1,0.2,0.3,0.4,50%\n", "mine.csv:2: column 'y1': got '50%', expec"),
    "a target too large": (HEADER + b"1,1,1,1,1.5\n", "mine.csv: column 'y1': got a target of 1.5"),
    "a target of 0": (HEADER + b"1,1,1,0,1\n", "mine.csv: column 'y0' holds a target of 0, whose"),
}
# Columns from which nothing can be learnt, by the place of the column.
SAME = {0: "column 'x0': got 0.5 in every row", 4: "column 'y1': got 0.5 in every row"}


@pytest.mark.parametrize(
    ("content", "message"), TABLE.values(), ids=[name.replace(" ", "_") for name in TABLE]
)
def test_vectors_are_refused(desk: Desk, content: bytes, message: str) -> None:
    (desk.folder / "mine.csv").write_bytes(content)
    desk.refuses("bench", "mine.toml", says=message)


@pytest.mark.parametrize(("place", "message"), SAME.items())
def test_a_column_of_one_value_is_refused(desk: Desk, place: int, message: str) -> None:
    lines = (desk.folder / "mine.csv").read_text(encoding="utf-8").splitlines()
    rows = [line.split(",") for line in lines]
    for row in rows[1:]:
        row[place] = "0.5"
    text = "\n".join(",".join(row) for row in rows)
    (desk.folder / "mine.csv").write_text(text, encoding="utf-8")
    desk.refuses("train", "mine.toml", says=f"mine.csv: {message}, expected values that differ")


def test_too_few_rows_are_refused(desk: Desk) -> None:
    lines = (desk.folder / "mine.csv").read_text(encoding="utf-8").splitlines(keepends=True)
    (desk.folder / "mine.csv").write_text("".join(lines[:4]), encoding="utf-8")
    desk.refuses("train", "mine.toml", says="mine.csv: got 3 rows, expected at least 8 to split")
