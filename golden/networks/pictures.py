"""How data flow through the parts of a network, for the picture of the datapath."""

from dataclasses import dataclass
from functools import singledispatch

from golden.activation.bipartite_table import RESULT
from golden.common.block import Block
from golden.engine.formats import WORD
from golden.networks.adder_graph import AdderGraph
from golden.networks.axis_network import TDATA, AxisNetwork
from golden.networks.cascade import Cascade
from golden.networks.engine import Engine
from golden.networks.hybrid import Hybrid
from golden.networks.multiple import Multiple
from golden.networks.parallel import Parallel
from golden.networks.windowed import Windowed
from golden.numbers.fixed import Fix
from golden.numbers.precision import SIGNAL


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
Step = Wire | Block | Replicated | SideBySide | WithController | None


@dataclass(frozen=True)
class Flow:
    """The steps of data through a block; parts that are no step are drawn below them.

    across: Whether it is drawn from left to right; otherwise from top to bottom.
    watcher: A part that observes the frames and is no part of the flow.
    """

    steps: tuple[Step, ...]
    across: bool = False
    watcher: Block | None = None


@singledispatch
def flow_of(_: Block) -> Flow | None:
    """How data flow through the parts of a block; None if the list of parts says enough."""
    return None


@flow_of.register
def _(network: Hybrid) -> Flow:
    hidden, first = len(network.activations), network.input_integral
    return Flow(
        (
            Wire(f"{network.inputs} x", first.in_fmt),
            WithController(network.input_controller, first),
            Wire(f"{hidden} q", first.out_fmt),
            Replicated(network.activations),
            Wire(f"{hidden} r", network.activations[0].out_fmt),
            WithController(network.output_controller, network.output_integral),
            Wire(f"{network.outputs} y", network.output_integral.out_fmt),
        ),
        across=True,
    )


@flow_of.register
def _(network: Parallel) -> Flow:
    first, last = network.hidden_neurons, network.output_neurons
    return Flow(
        (
            Wire(f"{network.inputs} x", first[0].in_fmt),
            Replicated(first),
            Wire(f"{len(first)} q", first[0].out_fmt),
            Replicated(network.activations),
            Wire(f"{len(first)} r", network.activations[0].out_fmt),
            Replicated(last),
            Wire(f"{network.outputs} y", last[0].out_fmt),
        ),
        across=True,
        watcher=network.input_controller,
    )


@flow_of.register
def _(network: AdderGraph) -> Flow:
    steps: list[Step] = [Wire(f"{network.inputs} x", SIGNAL)]
    for n, (matrix, activations) in enumerate(
        zip(network.layers, network.activations, strict=False)
    ):
        steps += [matrix, Wire(f"{len(matrix.weights)} q", matrix.out_fmt)]
        if activations:
            steps += [Replicated(network.tables(n)), Wire(f"{len(activations)} r", RESULT)]
    outputs = network.layers[-1]
    steps += [outputs, Wire(f"{network.outputs} y", outputs.out_fmt)]
    return Flow(tuple(steps), across=True)


@flow_of.register
def _(network: Engine) -> Flow:
    memory: list[Step] = []
    for one in network.lane_memories[:1]:
        memory = [one, Wire("a coefficient in each lane", WORD)]
    words = f"a word in each of {network.lanes} lanes" if network.lanes > 1 else "a word"
    return Flow(
        (
            Wire(f"{network.inputs} x", SIGNAL),
            network.rounds[0],
            Wire("samples, results", WORD),
            network.operand_memory,
            Wire(words, WORD),
            *memory,
            network.accumulators[0],
            Wire(f"{network.outputs} y", SIGNAL),
        ),
        watcher=network.frame_guard if network.loaded else network.frame_check,
    )


@flow_of.register
def _(network: Multiple) -> Flow:
    return Flow(
        (
            Wire("samples", SIGNAL),
            SideBySide(network.networks),
            Wire("every y", SIGNAL),
            network.output_collector,
            Wire("outputs", SIGNAL),
        )
    )


@flow_of.register
def _(network: Cascade) -> Flow:
    steps: list[Step] = [Wire(f"frames of {network.input_controller.inputs} elements", SIGNAL)]
    if network.frame_store:
        steps += [WithController(network.input_controller, network.frame_store)]
        steps += [Wire("good frames", SIGNAL)]
    for member, multiplexer in zip(network.networks, network.multiplexers, strict=False):
        steps += [member, None, multiplexer, Wire(f"y in slot {multiplexer.slot}", SIGNAL)]
    steps += [network.networks[-1], Wire("every y", SIGNAL)]
    steps += [network.output_collector, Wire("outputs", SIGNAL)]
    return Flow(tuple(steps), watcher=None if network.frame_store else network.input_controller)


@flow_of.register
def _(network: Windowed) -> Flow:
    return Flow(
        (
            Wire(f"{network.inputs} x", SIGNAL),
            network.frame_window,
            Wire(f"{network.network.inputs} x, past and present", SIGNAL),
            network.network,
            Wire(f"{network.outputs} y", SIGNAL),
        )
    )


@flow_of.register
def _(network: AxisNetwork) -> Flow:
    return Flow((Wire("s_axis", TDATA), network.network, Wire("m_axis", TDATA)))
