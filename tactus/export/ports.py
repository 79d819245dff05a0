"""The ports of an exported entity, read from its header, and the endings of its files."""

import re

from golden.common.block import Block
from golden.common.port import Port

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
