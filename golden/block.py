"""What every block's twin has in common: a name, its parts and its elaboration constants."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

if TYPE_CHECKING:
    from golden.flow import Flow


@dataclass(frozen=True)
class Block:
    """Elaboration constants of one block together with its bit-true function.

    A subclass sets ``block``, the name that is the block's address in every room, holds its
    constants as fields, and computes values (never cycles) in ``process``.

    Parameters
    ----------
    variant : str
        Tells instances with different constants apart; part of the entity's name.
    """

    block: ClassVar[str] = ""
    area: ClassVar[str] = ""
    variant: str = field(default="", kw_only=True)

    @property
    def entity(self) -> str:
        """Name of the VHDL entity and Verilog module."""
        return f"{self.block}_{self.variant}" if self.variant else self.block

    def parts(self) -> tuple[Block, ...]:
        """The blocks this one is assembled from."""
        return ()

    def flow(self) -> Flow | None:
        """How data goes through the parts, where there is more to tell than their list."""
        return None

    def facts(self) -> tuple[str, ...]:
        """What a picture tells of the block beside its formats."""
        return ()


def walk(top: Block) -> Iterator[Block]:
    """Every distinct block under ``top``, leaves first, ``top`` last.

    Raises
    ------
    ValueError
        When two blocks share an entity name but not their constants: one would overwrite the
        other on export.
    """
    seen: dict[str, Block] = {}

    def visit(block: Block) -> Iterator[Block]:
        if block.entity in seen:
            if seen[block.entity] != block:
                raise ValueError(f"{block.entity}: two different blocks want this entity name")
            return
        for part in block.parts():
            yield from visit(part)
        seen[block.entity] = block
        yield block

    yield from visit(top)
