"""The text that MyHDL writes, made to read as if written by hand.

Each rule changes the text alone, never what it means: the code of a Verilog file keeps every
token, but for the last words of a memory, which become a loop where they are equal.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

_COMMENT = {"vhdl": "--", "verilog": "//"}
# Calls of what pck_myhdl_011 declares: flags from and to conditions, and a negated unsigned.
_PACKAGE_USED = re.compile(r"\b(?:stdl|bool|tern_op)\(|\bto_(?:un)?signed\((?!-?\d)|\(- (?!\d)")


def tidy(
    text: str, language: str, heading: Sequence[str], meanings: Mapping[str, Sequence[str]]
) -> str:
    """The text of a file.

    Parameters
    ----------
    text : str
        As MyHDL wrote it.
    language : str
        "vhdl" or "verilog".
    heading : sequence of str
        Lines of the comment at its top, instead of the docstring that MyHDL copies.
    meanings : mapping of str to sequence of str
        By the label of a process that reads a table, or the name of a memory: what each word stands
        for.
    """
    comment = _COMMENT[language]
    text = re.sub(rf"^{comment}.*\n", "", text, flags=re.M)
    if language == "vhdl":
        for rule in _VHDL_RULES:
            text = rule(text)
    text = annotate_tables(text, language, meanings)
    if language == "vhdl":
        text = indent_architecture(drop_unused_packages(text))
    top = "".join(f"{comment} {line}".rstrip() + "\n" for line in heading)
    text = re.sub(r"[ \t]+$", "", text, flags=re.M).strip()
    return re.sub(r"\n{3,}", "\n\n", f"{top}\n{text}\n")


def name_architecture(text: str) -> str:
    """Every architecture is called rtl."""
    return re.sub(r"\barchitecture MyHDL\b", "architecture rtl", text)


def fold_numbers(text: str) -> str:
    """A difference of two numbers as a number: ``(4 - 1)`` is 3, ``0 to 9-1`` is ``0 to 8``.

    Strict VHDL-93 wants literals as universal bounds.
    """

    def difference(found: re.Match[str]) -> str:
        value = int(found[1]) - int(found[2])
        return str(value) if value >= 0 else found[0]

    text = re.sub(r"(?<![\w'])\((\d+) - (\d+)\)", difference, text)
    text = re.sub(r"(?<=\b[01] to )(\d+)-(1)\b", difference, text)
    return re.sub(r"\b(\d+)-(1)(?= downto \d)", difference, text)


def drop_shifts_by_nothing(text: str) -> str:
    """``shift_right(x, 0)`` is ``x``."""
    return re.sub(r"\bshift_(?:left|right)\((\w+), 0\)", r"\1", text)


def compare_flags(text: str) -> str:
    """``if bool(x) then`` with a std_logic ``x`` is ``if x = '1' then``."""
    flags = set(re.findall(r"^\s*(?:signal )?(\w+): (?:in |out )?std_logic;?$", text, re.M))

    def comparison(found: re.Match[str]) -> str:
        return f"{found[1]} {found[2]} = '1' then" if found[2] in flags else found[0]

    return re.sub(r"\b(if|elsif) bool\((\w+)\) then", comparison, text)


def drop_parentheses(text: str) -> str:
    """None around an assigned expression, a condition or ``- 5``, and none twice."""
    text = re.sub(r"(?<=[<>=] )\(- (\d+)\)", r"-\1", text)
    text = re.sub(r"\(\(([^()]*)\)\)", r"(\1)", text)
    return re.sub(r"( <= |if )\((.*)\)(;| then)$", _bare, text, flags=re.M)


def _bare(found: re.Match[str]) -> str:
    """Without the outermost parentheses, if they belong together."""
    depth = 0
    for character in found[2]:
        depth += {"(": 1, ")": -1}.get(character, 0)
        if depth < 0:
            return found[0]
    return "".join(found.groups())


def drop_empty_loops(text: str) -> str:
    """No loop from 1 to 0."""
    return re.sub(r"^ *for \w+ in 1 to 0 loop\n.*\n *end loop;\n", "", text, flags=re.M)


def fill_arrays(text: str) -> str:
    """All elements of an array that take the same word, one after the other, take it at once."""

    def fill(found: re.Match[str]) -> str:
        last = re.search(rf"\btype t_array_{found[2]} is array\(0 to (\d+)\)", text)
        if not last or found[0].count("\n") != int(last[1]) + 1:
            return found[0]
        return f"{found[1]}{found[2]} <= (others => {found[3]});\n"

    return re.sub(r"^( *)(\w+)\(0\) <= (.*);\n(?:\1\2\(\d+\) <= \3;\n)*", fill, text, flags=re.M)


def close_ranges(text: str) -> str:
    """``signed(13 downto 0)`` without a blank, as ``unsigned(13 downto 0)``."""
    return text.replace("signed (", "signed(")


def drop_unused_packages(text: str) -> str:
    """``use`` of text files and of MyHDL's functions only where they are used."""
    if not re.search(r"\b(?:write|writeline)\(|: line\b", text):
        text = text.replace("use std.textio.all;\n", "")
    if not _PACKAGE_USED.search(text):
        text = text.replace("use work.pck_myhdl_011.all;\n", "")
    return text


def annotate_tables(text: str, language: str, meanings: Mapping[str, Sequence[str]]) -> str:
    """Beside each word of a table what it stands for; equal last words as one row.

    A table of one word needs no rows, and without a clock no process: the word is assigned. In
    Verilog a ``case`` keeps its rows.

    Raises
    ------
    ValueError
        When a label is neither that of a process that reads a table nor the name of a memory.
    """
    for label, words in meanings.items():
        forms = ((_annotate, _PROCESS[language]), (_annotate_memory, _MEMORY[language]))
        found = [
            (match, annotate)
            for annotate, form in forms
            for match in re.finditer(form.format(label=label), text, re.M | re.S)
        ]
        if len(found) != 1:
            raise ValueError(f"{label}: got {len(found)} tables of this name, expected 1")
        match, annotate = found[0]
        table = annotate(match[0], language, words)
        text = f"{text[: match.start()]}{table}{text[match.end() :]}"
    return text


# From the label to the end of the process or, in Verilog, of the table.
_PROCESS = {
    "vhdl": r"^{label}: process\b.*?^end process {label};",
    "verilog": r"\bbegin: {label}$.*?^ +endcase",
}
_MEMORY = {
    "vhdl": r"^constant {label}: \w+ := \(\n.*?\);$",
    "verilog": r"^initial begin\n(?: +{label}\[\d+\] <= \S+;\n)+end$",
}
_ROW = re.compile(r"^ +(?:when )?(\w+)(?: =>|:) (\w+ <?= .*;)\n", re.M)


def _annotate(process: str, language: str, words: Sequence[str]) -> str:
    rows = list(_ROW.finditer(process))
    if not rows:
        raise ValueError(f"{process.splitlines()[0]}: got no table in this process, expected one")
    before, after = process[: rows[0].start()], process[rows[-1].end() :]
    lines = [row[0].rstrip() for row in rows]
    if language == "vhdl":
        while len(rows) > 1 and rows[-2][2] == rows[-1][2]:
            del rows[-2], lines[-2]
        if len(rows) == 1 and "rising_edge" not in before:
            before, after = "", ""
            lines = [rows[0][2]]
        elif len(rows) == 1:
            # Where the line of the case begins; the word takes its place.
            case = before.rstrip("\n").rfind("\n") + 1
            indent = before[case:].partition("case")[0]
            before, lines = before[:case], [f"{indent}{rows[0][2]}"]
            after = after.partition("end case;\n")[2]
    noted = "\n".join(_noted(lines, language, words))
    return before + noted + (f"\n{after}" if after else "")


def _annotate_memory(memory: str, language: str, words: Sequence[str]) -> str:
    first, *rows = memory.splitlines()
    if language == "vhdl":
        values = [row.strip().removesuffix(",").removesuffix(");") for row in rows]
        alike = _alike(values)
        if alike < len(values) - 1:
            values[alike:] = [f"others => {values[-1]}"]
            words = [*words[:alike], words[-1]]
        rows = [f"    {value}," for value in values[:-1]] + [f"    {values[-1]});"]
        return "\n".join([first, *_noted(rows, language, words)])
    *rows, last = rows
    alike = _alike([row.partition(" <= ")[2] for row in rows])
    if alike < len(rows) - 1:
        name, value = rows[-1].strip().split("[")[0], rows[-1].partition(" <= ")[2]
        count = f"{name}_n"
        steps = f"{count} = {alike}; {count} < {len(rows)}; {count} = {count} + 1"
        rows[alike:] = [f"    for ({steps}) {name}[{count}] <= {value}"]
        first = f"integer {count};\n{first}"
        words = [*words[:alike], words[-1]]
    return "\n".join([first, *_noted(rows, language, words), last])


def _alike(values: Sequence[str]) -> int:
    """The place of the first of the last values that are all equal."""
    place = len(values) - 1
    while place and values[place - 1] == values[-1]:
        place -= 1
    return place


def _noted(lines: Sequence[str], language: str, words: Sequence[str]) -> Iterator[str]:
    for place, line in enumerate(lines):
        yield f"{line}  {_COMMENT[language]} {words[min(place, len(words) - 1)]}"


def indent_architecture(text: str) -> str:
    """Declarations and statements stand four blanks in."""
    begin = re.search(r"^architecture .*\n", text, re.M)
    end = re.search(r"^end architecture ", text, re.M)
    if not begin or not end:
        return text
    inside = text[begin.end() : end.start()].split("\n")
    border = inside.index("begin")
    lines = [f"    {line}" if line and i != border else line for i, line in enumerate(inside)]
    body = "\n".join(lines).rstrip()
    return f"{text[: begin.end()]}{body}\n\n{text[end.start() :]}"


def shorten_bit_strings(text: str) -> str:
    """``36X"..."`` is VHDL-2008; at four bits a digit, or else bit by bit, it is older."""

    def literal(found: re.Match[str]) -> str:
        width, digits = int(found[1]), found[2]
        return f'X"{digits}"' if width == 4 * len(digits) else f'"{int(digits, 16):0{width}b}"'

    return re.sub(r'\b(\d+)X"([0-9a-f]+)"', literal, text)


_VHDL_RULES = (
    shorten_bit_strings,
    name_architecture,
    fold_numbers,
    drop_shifts_by_nothing,
    compare_flags,
    drop_parentheses,
    drop_empty_loops,
    fill_arrays,
    close_ranges,
)
