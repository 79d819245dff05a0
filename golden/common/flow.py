"""How data flow through the parts of a block, for the picture of the datapath."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Union

from golden.numbers.fixed import Fix

if TYPE_CHECKING:
    from golden.common.block import Block


@dataclass(frozen=True)
class Wire:
    """The data that goes from one step to the next, with its format or its number of bits."""

    what: str
    form: Fix | int


@dataclass(frozen=True)
class Replicated:
    """Blocks of one kind that work side by side and are drawn as one box."""

    blocks: tuple[Block, ...]


@dataclass(frozen=True)
class SideBySide:
    """Blocks that work side by side and are drawn as separate boxes."""

    blocks: tuple[Block, ...]


@dataclass(frozen=True)
class WithController:
    """A block through which data flows, and the block that controls it."""

    controller: Block
    block: Block


# ``None`` is an arrow without a text.
Step = Union[Wire, "Block", Replicated, SideBySide, WithController, None]


@dataclass(frozen=True)
class Flow:
    """The steps of data through a block; parts that are no step are drawn below them.

    across: Whether it is drawn from left to right; otherwise from top to bottom.
    watcher: A part that observes the frames and is no part of the flow.
    """

    steps: tuple[Step, ...]
    across: bool = False
    watcher: Block | None = None

    @property
    def blocks(self) -> tuple[Block, ...]:
        """All blocks that it names, the watcher first."""
        found = [self.watcher] if self.watcher else []
        for step in self.steps:
            match step:
                case Replicated(blocks) | SideBySide(blocks):
                    found += blocks
                case WithController(controller, block):
                    found += [controller, block]
                case None | Wire():
                    pass
                case _:
                    found.append(step)
        return tuple(found)
