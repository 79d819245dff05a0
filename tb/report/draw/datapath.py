"""The hardware of a scene as a block diagram, drawn from its design."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from golden.activation.rom import Rom
from golden.block import Block
from golden.fixed import Fix
from golden.instruments.instrument import Instrument
from golden.instruments.readout import Readout
from golden.layers.input_controller import InputController
from golden.networks.axis_network import TDATA, AxisNetwork
from golden.networks.cascade import Cascade
from golden.networks.hybrid import Hybrid
from golden.networks.multiple import Multiple
from golden.networks.parallel import Parallel
from golden.precision import SIGNAL
from golden.scene import Scene
from golden.visualisation.load_profile import LoadProfile
from tb.report.draw.drawing import picture
from tb.report.draw.layout import Part, arrow, column, labelled, row, side_by_side

MARGIN = 8.0
# Parts of which nothing but their number is told stand in columns of this many.
STACK = 3


def datapath(scene: Scene) -> str:
    """Every block of the scene's design, with how many there are, its formats and its latency.

    Blocks of one kind that stand side by side share a box; its tip names their entities. Within a
    network data flows from left to right, from network to network downwards.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    str
        One ``<svg>`` element, wider than a phone.

    Raises
    ------
    FileNotFoundError, ValueError
        See ``Scene.twin``.
    """
    design = scene.twin()
    drawn = _Diagram().blocks([design])
    size = (drawn.width + 2 * MARGIN, drawn.height + 2 * MARGIN)
    title = f"Datapath of scene {scene.name}: the blocks of {design.entity}"
    return picture(title, size, drawn.draw((MARGIN, MARGIN)), min(size[0], 900), size[0] * 1.1)


class _Diagram:
    """Boxes of blocks, with their latencies written into them."""

    def __init__(self) -> None:
        # Entities in the order in which they were placed.
        self.placed: list[str] = []

    def blocks(self, same: Sequence[Block]) -> Part:
        """One box for blocks of one kind that do their work side by side."""
        first = same[0]
        self.placed += [block.entity for block in same]
        title = f"{len(same)} × {first.block}" if len(same) > 1 else first.entity
        tip = ", ".join(dict.fromkeys(block.entity for block in same))
        return labelled(title, self._lines(same), self._inside(same), tip)

    def _lines(self, same: Sequence[Block]) -> list[str]:
        """Clocks, from the least to the most, and the facts that all of the blocks share."""
        clocks = sorted({block.latency for block in same})
        words = " to ".join(str(n) for n in dict.fromkeys((clocks[0], clocks[-1])))
        shared = [fact for fact in _facts(same[0]) if all(fact in _facts(b) for b in same)]
        return [f"{words} clock{'' if clocks == [1] else 's'}", *shared]

    def _inside(self, same: Sequence[Block]) -> Part | None:
        """The parts of blocks of one kind; what a plan does not know stands below it."""
        parts = [part for block in same for part in block.parts()]
        if not parts:
            return None
        start = len(self.placed)
        planned = self._plan(same[0]) if len(same) == 1 else None
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
        """Parts of one kind that several blocks own; one for each of them goes without saying."""
        if owners == 1 or len(same) != owners:
            return self.blocks(same)
        tip = ", ".join(dict.fromkeys(block.entity for block in same))
        return labelled(same[0].block, self._lines(same), self._inside(same), tip)

    def _plan(self, block: Block) -> Part | None:
        """How the parts of a block stand to each other, where that is known."""
        match block:
            case Hybrid():
                return self._hybrid(block)
            case Parallel():
                return self._parallel(block)
            case Cascade():
                return self._cascade(block)
            case Multiple():
                return self._multiple(block)
            case LoadProfile():
                return self._load_profile(block)
            case Readout():
                return self._readout(block)
            case Instrument(scan_sequencer=scan, readout=readout):
                given = arrow(_carried("codes of the converter", SIGNAL), False)
                between = arrow((), False)
                return column([given, self.blocks([scan]), between, self.blocks([readout])])
            case AxisNetwork(network=network):
                given = arrow(_carried("s_axis", TDATA), False)
                return column(
                    [given, self.blocks([network]), arrow(_carried("m_axis", TDATA), False)]
                )
        return None

    def _readout(self, block: Readout) -> Part:
        flow = [arrow(_carried("samples", SIGNAL), False), self.blocks([block.network])]
        flow.append(arrow(_carried("outputs", SIGNAL), False))
        if block.load_profile:
            flow.append(self.blocks([block.load_profile]))
            flow.append(arrow(_carried("profile", SIGNAL), False))
        return column(flow)

    def _hybrid(self, block: Hybrid) -> Part:
        node, activation = block.input_integral.nodes[0], block.activations[0]
        hidden = len(block.activations)
        down = arrow((), False, 14)
        first = [self.blocks([block.input_controller]), down, self.blocks([block.input_integral])]
        last = [self.blocks([block.output_controller]), down, self.blocks([block.output_integral])]
        flow = [
            arrow(_carried(f"{block.inputs} x", node.in_fmt)),
            column(first, main=2),
            arrow(_carried(f"{hidden} q", node.out_fmt)),
            self.blocks(block.activations),
            arrow(_carried(f"{hidden} r", activation.out_fmt)),
            column(last, main=2),
            arrow(_carried(f"{block.outputs} y", block.output_integral.out_fmt)),
        ]
        return row(flow)

    def _parallel(self, block: Parallel) -> Part:
        first, activation, last = block.hidden_neurons, block.activations, block.output_neurons
        flow = [
            arrow(_carried(f"{block.inputs} x", first[0].in_fmt)),
            self.blocks(first),
            arrow(_carried(f"{len(first)} q", first[0].out_fmt)),
            self.blocks(activation),
            arrow(_carried(f"{len(activation)} r", activation[0].out_fmt)),
            self.blocks(last),
            arrow(_carried(f"{block.outputs} y", last[0].out_fmt)),
        ]
        return column([self.blocks([block.input_controller]), row(flow)], 10)

    def _cascade(self, block: Cascade) -> Part:
        length = block.input_controller.inputs
        flow = [arrow([f"frames of {length} elements", str(SIGNAL)], False)]
        for network, multiplexer in zip(block.networks, block.multiplexers, strict=False):
            flow += [self.blocks([network]), arrow((), False), self.blocks([multiplexer])]
            flow.append(arrow([f"y in slot {multiplexer.slot}", str(SIGNAL)], False))
        flow += [self.blocks([block.networks[-1]]), arrow(_carried("every y", SIGNAL), False)]
        collector = self.blocks([block.output_collector])
        end = column([collector, arrow(_carried("outputs", SIGNAL), False)], main=0)
        # The controller looks at the frames alone: it takes no part in the flow.
        judge = replace(self.blocks([block.input_controller]), ay=end.ay)
        flow.append(row([end, judge], 90, main=0))
        return column(flow)

    def _multiple(self, block: Multiple) -> Part:
        networks = side_by_side([self.blocks([network]) for network in block.networks])
        flow = [
            arrow(_carried("samples", SIGNAL), False),
            networks,
            arrow(_carried("every y", SIGNAL), False),
            self.blocks([block.output_collector]),
            arrow(_carried("outputs", SIGNAL), False),
        ]
        return column(flow)

    def _load_profile(self, block: LoadProfile) -> Part:
        divider, fold, memory = block.divider, block.power_fold, block.exp_memory
        interpolator = block.exp_interpolator
        flow = [
            self.blocks([block.ramp]),
            arrow(["distance", _bits(divider.distance_width)]),
            self.blocks([divider]),
            arrow(["t", _bits(divider.out_width)]),
            self.blocks([fold]),
            arrow(["x", _bits(fold.out_width)]),
            self.blocks([memory]),
            arrow(["word", _bits(memory.width)]),
            self.blocks([interpolator]),
            arrow(["exp(-x)", _bits(interpolator.word_width)]),
        ]
        return row(flow)


def _carried(what: str, fmt: Fix) -> list[str]:
    return [what, str(fmt)]


def _bits(width: int) -> str:
    return f"{width} bits"


def _facts(block: Block) -> list[str]:
    """Formats and sizes of a block, where the design tells them."""
    lines = []
    taken, given = (getattr(block, name, None) for name in ("in_fmt", "out_fmt"))
    if taken and given:
        lines.append(f"{taken} to {given}")
    weights = getattr(block, "coeff_fmt", None)
    if weights:
        lines.append(f"weights {weights}")
    if isinstance(block, Rom):
        lines.append(f"{len(block.words)} words of {block.width} bits")
    if isinstance(block, InputController):
        lines.append(f"{block.inputs} element{'s' if block.inputs > 1 else ''} a frame")
    return lines
