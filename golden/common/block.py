"""What the twins of all blocks have in common: a name, parts and elaboration constants."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import ClassVar

from golden.common.border import Border, State
from golden.common.flow import Flow
from golden.common.port import Port
from golden.input_error import InputError
from golden.numbers.fixed import Codes


@dataclass(frozen=True)
class Block:
    """Elaboration constants of one block together with its bit-true function.

    A subclass sets ``block``, the name that is the block's address in every room, and holds its
    constants as fields. Its ``process`` computes values, never cycles. It also publishes the ports
    and the clocks of its hardware, and a bench checks that the hardware has them.

    variant: Distinguishes instances with different constants; it is part of the entity's name.
    """

    block: ClassVar[str] = ""
    area: ClassVar[str] = ""
    # The section of the thesis that describes it; empty for blocks that are ours.
    section: ClassVar[str] = ""
    # The block that it is a part of and that is judged with it; empty for a block of its own.
    part_of: ClassVar[str] = ""
    variant: str = field(default="", kw_only=True)

    @property
    def entity(self) -> str:
        """Name of the VHDL entity and Verilog module."""
        return f"{self.block}_{self.variant}" if self.variant else self.block

    def check(self, **ends: tuple[int, int | None]) -> None:
        """Refuse constants that are not between their least and their largest value, if any."""
        for name, (low, high) in ends.items():
            got = getattr(self, name)
            if got < low or (high is not None and got > high):
                expected = f"{low} or more" if high is None else f"{low} to {high}"
                raise InputError(f"{self.entity}: got {name}={got}, expected {expected}")

    def require(self, right: bool, got: str, expected: str) -> None:
        """Refuse constants that do not go together, under ``python -O`` too."""
        if not right:
            raise InputError(f"{self.entity}: got {got}, expected {expected}")

    @property
    def ports(self) -> tuple[Port, ...]:
        """The ports of the entity, in their order."""
        raise NotImplementedError(f"{self.entity}: its twin publishes no ports")

    @property
    def latency(self) -> int:
        """Clocks from a result's cause to the result; docs/streams.md says what is counted."""
        raise NotImplementedError(f"{self.entity}: its twin publishes no latency")

    @property
    def borders(self) -> tuple[Border, ...]:
        """The values at which its behaviour changes; a bench drives both sides of each."""
        return ()

    def quantities(self, *inputs: Codes) -> dict[str, Codes]:
        """The quantities that have borders, for the inputs of ``process``."""
        return {}

    @property
    def states(self) -> tuple[State, ...]:
        """The numbers that it holds; a bench reaches each of their values."""
        return ()

    @property
    def unreachable(self) -> dict[str, str]:
        """Values of small ports that never occur, as ``port=value``, each with the reason."""
        return {}

    @property
    def data_flags(self) -> frozenset[str]:
        """Flags that travel with their data, and so need no reset."""
        return frozenset()

    @property
    def interval(self) -> int:
        """Least clocks from one input to the next."""
        return 1

    def parts(self) -> tuple[Block, ...]:
        """The blocks of which this one is assembled."""
        return ()

    def flow(self) -> Flow | None:
        """How data flow through it; None if the list of parts says enough."""
        return None

    def facts(self) -> tuple[str, ...]:
        """Facts that a picture shows about the block, besides its formats."""
        return ()


def walk(top: Block) -> Iterator[Block]:
    """Every distinct block under ``top``, the leaves first and ``top`` last."""
    seen: dict[str, Block] = {}

    def visit(block: Block) -> Iterator[Block]:
        if block.entity in seen:
            if seen[block.entity] != block:
                raise InputError(f"{block.entity}: two different blocks want this entity name")
            return
        for part in block.parts():
            yield from visit(part)
        seen[block.entity] = block
        yield block

    yield from visit(top)


def parts_of(top: Block) -> list[Block]:
    """The parts that are judged with ``top``, the innermost first, without blocks of their own."""
    found: dict[str, Block] = {}
    for part in (part for part in top.parts() if part.part_of):
        found |= {one.entity: one for one in (*parts_of(part), part)}
    return list(found.values())


def around(top: Block, part: Block) -> Iterator[Block]:
    """Every distinct block under ``top`` that contains ``part``, the innermost first."""
    for block in walk(top):
        if block.entity != part.entity and part.entity in {inner.entity for inner in walk(block)}:
            yield block
