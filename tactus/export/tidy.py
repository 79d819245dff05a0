"""Makes the text that MyHDL writes read as if it were written by hand, and reads its ports.

Each rule changes the text alone and never its meaning. The code of a Verilog file keeps every
token, except the last words of a memory, which become a loop where they are equal.
"""

import re
from collections.abc import Iterator, Mapping, Sequence

from golden.common.block import Block
from golden.common.port import Port

_COMMENT = {"vhdl": "--", "verilog": "//"}
# Calls of functions that pck_myhdl_011 declares: they turn conditions into flags and back, and
# negate an unsigned.
_PACKAGE_USED = re.compile(r"\b(?:stdl|bool|tern_op)\(|\bto_(?:un)?signed\((?!-?\d)|\(- (?!\d)")


def tidy(
    text: str, language: str, heading: Sequence[str], meanings: Mapping[str, Sequence[str]]
) -> str:
    """The text of a file.

    text: The text as MyHDL wrote it.
    language: "vhdl" or "verilog".
    heading: The lines of the comment at the top, in place of the docstring that MyHDL copies.
    meanings: What each word of a table stands for, by the label of the process that reads the
        table, or by the name of the memory.
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


def fold_numbers(text: str) -> str:
    """A difference of two numbers becomes one: ``(4 - 1)`` is 3, and ``0 to 9-1`` is ``0 to 8``.

    Strict VHDL-93 wants literals where a bound is universal.
    """

    def difference(found: re.Match[str]) -> str:
        value = int(found[1]) - int(found[2])
        return str(value) if value >= 0 else found[0]

    text = re.sub(r"(?<![\w'])\((\d+) - (\d+)\)", difference, text)
    text = re.sub(r"(?<=\b[01] to )(\d+)-(1)\b", difference, text)
    return re.sub(r"\b(\d+)-(1)(?= downto \d)", difference, text)


# A name; a shift by nothing; an empty loop; a blank that MyHDL writes only behind ``signed``.
_REPLACED = (
    (r"\barchitecture MyHDL\b", "architecture rtl"),
    (r"\bshift_(?:left|right)\((\w+), 0\)", r"\1"),
    (r"^ *for \w+ in 1 to 0 loop\n.*\n *end loop;\n", ""),
    (r"signed \(", "signed("),
)


def replace_phrases(text: str) -> str:
    for pattern, replacement in _REPLACED:
        text = re.sub(pattern, replacement, text, flags=re.M)
    return text


def compare_flags(text: str) -> str:
    """``if bool(x) then`` becomes ``if x = '1' then`` where ``x`` is a std_logic."""
    flags = set(re.findall(r"^\s*(?:signal )?(\w+): (?:in |out )?std_logic;?$", text, re.M))

    def comparison(found: re.Match[str]) -> str:
        return f"{found[1]} {found[2]} = '1' then" if found[2] in flags else found[0]

    return re.sub(r"\b(if|elsif) bool\((\w+)\) then", comparison, text)


def drop_parentheses(text: str) -> str:
    """Remove parentheses around an assigned expression, a condition or ``- 5``, and double ones."""
    text = re.sub(r"(?<=[<>=] )\(- (\d+)\)", r"-\1", text)
    text = re.sub(r"\(\(([^()]*)\)\)", r"(\1)", text)
    return re.sub(r"( <= |if )\((.*)\)(;| then)$", _bare, text, flags=re.M)


def _bare(found: re.Match[str]) -> str:
    """The text without the outermost parentheses, if these belong together."""
    depth = 0
    for character in found[2]:
        depth += {"(": 1, ")": -1}.get(character, 0)
        if depth < 0:
            return found[0]
    return "".join(found.groups())


def fill_arrays(text: str) -> str:
    """Where all elements of an array take the same word in turn, one assignment does it."""

    def fill(found: re.Match[str]) -> str:
        last = re.search(rf"\btype t_array_{found[2]} is array\(0 to (\d+)\)", text)
        if not last or found[0].count("\n") != int(last[1]) + 1:
            return found[0]
        return f"{found[1]}{found[2]} <= (others => {found[3]});\n"

    return re.sub(r"^( *)(\w+)\(0\) <= (.*);\n(?:\1\2\(\d+\) <= \3;\n)*", fill, text, flags=re.M)


def drop_unused_packages(text: str) -> str:
    """Keep the ``use`` of MyHDL's functions only where the text needs them; no block prints."""
    text = text.replace("use std.textio.all;\n", "")
    if not _PACKAGE_USED.search(text):
        text = text.replace("use work.pck_myhdl_011.all;\n", "")
    return text


def annotate_tables(text: str, language: str, meanings: Mapping[str, Sequence[str]]) -> str:
    """Write beside each word of a table what it stands for; equal last words become one row.

    A table of one word needs no rows, and without a clock it needs no process: the word is
    assigned. In Verilog a ``case`` keeps its rows.
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


# A match begins at the label. It ends with the process or, in Verilog, with the table.
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
            # The word takes the place of the case, whose line begins here.
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
    """The place at which the equal values at the end begin."""
    place = len(values) - 1
    while place and values[place - 1] == values[-1]:
        place -= 1
    return place


def _noted(lines: Sequence[str], language: str, words: Sequence[str]) -> Iterator[str]:
    for place, line in enumerate(lines):
        yield f"{line}  {_COMMENT[language]} {words[min(place, len(words) - 1)]}"


def indent_architecture(text: str) -> str:
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
    """Write ``36X"..."``, which is VHDL-2008, as older VHDL: in whole hex digits or in binary."""

    def literal(found: re.Match[str]) -> str:
        width, digits = int(found[1]), found[2]
        return f'X"{digits}"' if width == 4 * len(digits) else f'"{int(digits, 16):0{width}b}"'

    return re.sub(r'\b(\d+)X"([0-9a-f]+)"', literal, text)


_VHDL_RULES = (
    shorten_bit_strings,
    fold_numbers,
    replace_phrases,
    compare_flags,
    drop_parentheses,
    fill_arrays,
)


_VHDL = re.compile(
    r"^\s+(?P<name>\w+): (?P<direction>in|out) "
    r"(?P<kind>std_logic|signed|unsigned)(?: ?\((?P<top>\d+) downto 0\))?;?$",
    re.M,
)
_VERILOG = re.compile(
    r"^(?P<direction>in|out)put (?P<kind>signed )?(?:\[(?P<top>\d+):0\] )?(?P<name>\w+);", re.M
)
SUFFIX = {"vhdl": ".vhd", "verilog": ".v"}
PATTERN = {"vhdl": _VHDL, "verilog": _VERILOG}


def header(text: str, language: str) -> list[tuple[str, str, int, bool]]:
    """Name, direction, width and whether it is signed of each port, in the order of the header.

    ``text`` is an entity or a module that MyHDL wrote.
    """
    return [
        (
            found["name"],
            found["direction"],
            int(found["top"]) + 1 if found["top"] else 0,
            (found["kind"] or "").strip() == "signed",
        )
        for found in PATTERN[language].finditer(text)
    ]


def read_ports(spec: Block, text: str, language: str) -> list[Port]:
    """The ports that the twin publishes, in the order in which MyHDL wrote them."""
    published = {port.name: port for port in spec.ports}
    return [published[name] for name, *_ in header(text, language)]


def vhdl_type(port: Port) -> str:
    if not port.width:
        return "std_logic"
    return f"{'signed' if port.signed else 'unsigned'}({port.width - 1} downto 0)"


def verilog_type(port: Port) -> str:
    """Signedness and range in Verilog, with a blank behind, or nothing."""
    span = f"[{port.width - 1}:0] " if port.width else ""
    return f"signed {span}" if port.signed else span


def check_ports(spec: Block, text: str, language: str) -> None:
    """Check that an entity or module has the ports that its twin publishes."""
    found = set(header(text, language))
    published = {(p.name, p.direction, p.width, p.signed) for p in spec.ports}
    if found != published:
        raise ValueError(
            f"{spec.entity}: got ports (name, direction, width, signed) "
            f"{sorted(found - published)}, expected {sorted(published - found)}, which the twin "
            "publishes"
        )


def comment_ports(spec: Block, text: str, language: str) -> str:
    """The text, in which a comment above every port gives its format and meaning."""
    comments = {port.name: port.comment for port in spec.ports}
    sign = {"vhdl": "--", "verilog": "//"}[language]

    def commented(found: re.Match[str]) -> str:
        indent = " " * (len(found[0]) - len(found[0].lstrip()))
        return f"{indent}{sign} {comments[found['name']]}\n{found[0]}"

    return PATTERN[language].sub(commented, text)
