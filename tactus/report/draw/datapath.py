"""Draws the hardware of a scene as a block diagram, from its design."""

from collections.abc import Sequence
from dataclasses import replace

from golden.common.block import Block
from golden.common.flow import Flow, Replicated, SideBySide, Step, Wire, WithController
from golden.instruments.pictures import flow_of
from tactus.report.draw.drawing import picture
from tactus.report.draw.layout import Part, arrow, column, labelled, row, side_by_side
from tactus.scene import Scene

MARGIN = 8.0
# Parts that only show their number are arranged in columns of this many.
STACK = 3


def datapath(scene: Scene) -> str:
    """Every block of the scene's design, with its count, its formats and its latency.

    Blocks of one kind that work side by side share a box, and its tooltip names their entities.
    Within a network data flows from left to right, and from network to network it flows down.

    Returns: One ``<svg>`` element, wider than a phone.
    """
    design = scene.twin()
    drawn = _Diagram().blocks([design])
    size = (drawn.width + 2 * MARGIN, drawn.height + 2 * MARGIN)
    title = f"Datapath of scene {scene.name}: the blocks of {design.entity}"
    return picture(title, size, drawn.draw((MARGIN, MARGIN)), min(size[0], 900), size[0] * 1.1)


class _Diagram:
    """Boxes of blocks, with their latencies written into them."""

    def __init__(self) -> None:
        # The entities in the order in which they were placed.
        self.placed: list[str] = []

    def blocks(self, same: Sequence[Block]) -> Part:
        """One box for blocks of one kind that work side by side."""
        first = same[0]
        self.placed += [block.entity for block in same]
        title = f"{len(same)} × {first.block}" if len(same) > 1 else first.entity
        tip = ", ".join(dict.fromkeys(block.entity for block in same))
        return labelled(title, self._lines(same), self._inside(same), tip)

    def _lines(self, same: Sequence[Block]) -> list[str]:
        """The range of the clocks, and the facts that all of the blocks share."""
        clocks = sorted({block.latency for block in same})
        words = " to ".join(str(n) for n in dict.fromkeys((clocks[0], clocks[-1])))
        shared = [fact for fact in _facts(same[0]) if all(fact in _facts(b) for b in same)]
        return [f"{words} clock{'' if clocks == [1] else 's'}", *shared]

    def _inside(self, same: Sequence[Block]) -> Part | None:
        """The parts of blocks of one kind. Parts that their flow leaves out are below it."""
        parts = [part for block in same for part in block.parts()]
        if not parts:
            return None
        start = len(self.placed)
        flow = flow_of(same[0]) if len(same) == 1 else None
        planned = self._flow(flow) if flow else None
        known = set(self.placed[start:])
        rest: dict[str, list[Block]] = {}
        for part in parts:
            if part.entity not in known:
                rest.setdefault(part.block, []).append(part)
        boxes = [self._share(kind, len(same)) for kind in rest.values()]
        stacks = [column(boxes[n : n + STACK], 6) for n in range(0, len(boxes), STACK)]
        groups = ([planned] if planned else []) + ([row(stacks, 6)] if stacks else [])
        return column(groups, 8)

    def _share(self, same: Sequence[Block], owners: int) -> Part:
        """Parts of one kind that several blocks own. One part for each block needs no count."""
        if owners == 1 or len(same) != owners:
            return self.blocks(same)
        tip = ", ".join(dict.fromkeys(block.entity for block in same))
        return labelled(same[0].block, self._lines(same), self._inside(same), tip)

    def _flow(self, flow: Flow) -> Part:
        """The steps in their order. What watches them is above them, or beside the end."""
        parts = [self._step(step, flow.across) for step in flow.steps]
        if flow.across:
            watcher = [self.blocks([flow.watcher])] if flow.watcher else []
            return column([*watcher, row(parts)], 10)
        if flow.watcher:
            last = max(n for n, step in enumerate(flow.steps) if isinstance(step, Block))
            end = column(parts[last:], main=0)
            watcher = [replace(self.blocks([flow.watcher]), ay=end.ay)]
            parts[last:] = [row([end, *watcher], 90, main=0)]
        return column(parts)

    def _step(self, step: Step, across: bool) -> Part:
        match step:
            case None:
                return arrow((), across)
            case Wire(what, form):
                bits = f"{form} bits" if isinstance(form, int) else str(form)
                return arrow((what, bits), across)
            case Replicated(blocks):
                return self.blocks(blocks)
            case SideBySide(blocks):
                return side_by_side([self.blocks([block]) for block in blocks])
            case WithController(controller, block):
                down = arrow((), False, 14)
                return column([self.blocks([controller]), down, self.blocks([block])], main=2)
        return self.blocks([step])


def _facts(block: Block) -> list[str]:
    """The formats and sizes of a block, if the design states them."""
    lines = []
    taken, given = (getattr(block, name, None) for name in ("in_fmt", "out_fmt"))
    if taken and given:
        lines.append(f"{taken} to {given}")
    weights = getattr(block, "coeff_fmt", None)
    if weights:
        lines.append(f"weights {weights}")
    return [*lines, *block.facts()]
