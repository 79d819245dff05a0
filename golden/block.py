"""What every block's twin has in common: a name, its parts and its elaboration constants."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

from golden.input_error import InputError

if TYPE_CHECKING:
    pass

from golden.border import Border, State
from golden.fixed import Codes
from golden.port import Port


@dataclass(frozen=True)
class Block:
    """Elaboration constants of one block together with its bit-true function.

    A subclass sets ``block``, the name that is the block's address in every room, holds its
    constants as fields, computes values (never cycles) in ``process``, and publishes ports and
    clocks of its hardware, which a bench holds it to.

    Parameters
    ----------
    variant : str
        Tells instances with different constants apart; part of the entity's name.
    """

    block: ClassVar[str] = ""
    area: ClassVar[str] = ""
    # Where the thesis describes it; empty for what is ours.
    section: ClassVar[str] = ""
    variant: str = field(default="", kw_only=True)

    @property
    def entity(self) -> str:
        """Name of the VHDL entity and Verilog module."""
        return f"{self.block}_{self.variant}" if self.variant else self.block

    @property
    def ports(self) -> tuple[Port, ...]:
        """The ports of its entity, in their order."""
        raise NotImplementedError(f"{self.entity}: its twin publishes no ports")

    @property
    def latency(self) -> int:
        """Clocks from a result's cause to the result; docs/streams.md says what is counted."""
        raise NotImplementedError(f"{self.entity}: its twin publishes no latency")

    @property
    def borders(self) -> tuple[Border, ...]:
        """Where it begins to do something else; a bench drives both sides of each."""
        return ()

    def quantities(self, *inputs: Codes) -> dict[str, Codes]:
        """What its borders are of, for the inputs of ``process``."""
        return {}

    @property
    def states(self) -> tuple[State, ...]:
        """Numbers it holds; a bench reaches each of their values."""
        return ()

    @property
    def unreachable(self) -> dict[str, str]:
        """Values of small ports that never stand there, as ``port=value``, and why."""
        return {}

    @property
    def data_flags(self) -> frozenset[str]:
        """Flags that stay with their data, and so have no reset."""
        return frozenset()

    @property
    def interval(self) -> int:
        """Least clocks from one input to the next."""
        return 1

    def parts(self) -> tuple[Block, ...]:
        """The blocks this one is assembled from."""
        return ()

    def facts(self) -> tuple[str, ...]:
        """What a picture tells of the block beside its formats."""
        return ()


def walk(top: Block) -> Iterator[Block]:
    """Every distinct block under ``top``, leaves first, ``top`` last.

    Raises
    ------
    InputError
        When two blocks share an entity name but not their constants: one would overwrite the
        other on export.
    """
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


def around(top: Block, part: Block) -> Iterator[Block]:
    """Every distinct block under ``top`` that contains ``part``, the innermost first."""
    for block in walk(top):
        if block.entity != part.entity and part.entity in {inner.entity for inner in walk(block)}:
            yield block
