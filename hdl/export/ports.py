"""The ports of an exported entity, read from its header."""

from __future__ import annotations

import re
from dataclasses import dataclass

from golden.block import Block

_VHDL = re.compile(
    r"^\s+(?P<name>\w+): (?P<direction>in|out) "
    r"(?P<kind>std_logic|signed|unsigned)(?: ?\((?P<top>\d+) downto 0\))?;?$",
    re.M,
)
_VERILOG = re.compile(
    r"^(?P<direction>in|out)put (?P<kind>signed )?(?:\[(?P<top>\d+):0\] )?(?P<name>\w+);", re.M
)
PATTERN = {"vhdl": _VHDL, "verilog": _VERILOG}


@dataclass(frozen=True)
class Port:
    """One port; a ``width`` of 0 means a single bit, which is no vector."""

    name: str
    direction: str
    width: int
    signed: bool

    @property
    def vhdl(self) -> str:
        """The port's type in VHDL."""
        if not self.width:
            return "std_logic"
        return f"{'signed' if self.signed else 'unsigned'}({self.width - 1} downto 0)"

    @property
    def verilog(self) -> str:
        """The signedness and range in Verilog, followed by a blank; empty for a single bit."""
        span = f"[{self.width - 1}:0] " if self.width else ""
        return f"signed {span}" if self.signed else span


def read_ports(text: str, language: str) -> list[Port]:
    """The ports of an entity or module that MyHDL wrote, in the order of its header."""
    return [
        Port(
            found["name"],
            found["direction"],
            int(found["top"]) + 1 if found["top"] else 0,
            (found["kind"] or "").strip() == "signed",
        )
        for found in PATTERN[language].finditer(text)
    ]


def check_ports(spec: Block, text: str, language: str) -> None:
    """Check that an entity or module has the ports that its twin publishes.

    Raises
    ------
    ValueError
        When it does not; the message names the ports that differ. The order does not matter,
        because MyHDL puts groups of ports behind the others.
    """
    found = {(p.name, p.direction, p.width, p.signed) for p in read_ports(text, language)}
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
