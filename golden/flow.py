"""How the parts of a block stand to each other, for the picture of the datapath."""

from __future__ import annotations

from dataclasses import dataclass

from golden.block import Block
from golden.fixed import Fix


@dataclass(frozen=True)
class Carried:
    """What goes from one step to the next, and its format or how many bits it has."""

    what: str
    form: Fix | int


@dataclass(frozen=True)
class Alike:
    """Blocks of one kind that do their work side by side: one box."""

    blocks: tuple[Block, ...]


@dataclass(frozen=True)
class Beside:
    """Blocks that do their work side by side, each in a box of its own."""

    blocks: tuple[Block, ...]


@dataclass(frozen=True)
class Controlled:
    """A block through which data flows, and the one that controls it."""

    controller: Block
    block: Block


# ``None`` is an arrow that needs no words.
Step = Carried | Block | Alike | Beside | Controlled | None


@dataclass(frozen=True)
class Flow:
    """The steps of data through a block; parts that it leaves out are drawn below it.

    Attributes
    ----------
    steps : tuple of Step
    across : bool
        From left to right, otherwise downwards.
    watcher : Block or None
        A part that looks at the frames and takes no part in the flow.
    """

    steps: tuple[Step, ...]
    across: bool = False
    watcher: Block | None = None
