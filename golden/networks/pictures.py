"""How data flow through the parts of a network, for the picture of the datapath."""

from functools import singledispatch

from golden.activation.bipartite_table import RESULT
from golden.common.block import Block
from golden.common.flow import Alike, Beside, Carried, Controlled, Flow, Step
from golden.engine.operand_memory import WORD
from golden.networks.adder_graph import AdderGraph
from golden.networks.axis_network import TDATA, AxisNetwork
from golden.networks.cascade import Cascade
from golden.networks.engine import Engine
from golden.networks.hybrid import Hybrid
from golden.networks.lanes import Lanes
from golden.networks.multiple import Multiple
from golden.networks.parallel import Parallel
from golden.networks.windowed import Windowed
from golden.numbers.precision import SIGNAL


@singledispatch
def flow_of(_: Block) -> Flow | None:
    """How data flow through the parts of a block; None if the list of parts says enough."""
    return None


@flow_of.register
def _(network: Hybrid) -> Flow:
    hidden, first = len(network.activations), network.input_integral
    return Flow(
        (
            Carried(f"{network.inputs} x", first.in_fmt),
            Controlled(network.input_controller, first),
            Carried(f"{hidden} q", first.out_fmt),
            Alike(network.activations),
            Carried(f"{hidden} r", network.activations[0].out_fmt),
            Controlled(network.output_controller, network.output_integral),
            Carried(f"{network.outputs} y", network.output_integral.out_fmt),
        ),
        across=True,
    )


@flow_of.register
def _(network: Parallel) -> Flow:
    first, last = network.hidden_neurons, network.output_neurons
    return Flow(
        (
            Carried(f"{network.inputs} x", first[0].in_fmt),
            Alike(first),
            Carried(f"{len(first)} q", first[0].out_fmt),
            Alike(network.activations),
            Carried(f"{len(first)} r", network.activations[0].out_fmt),
            Alike(last),
            Carried(f"{network.outputs} y", last[0].out_fmt),
        ),
        across=True,
        watcher=network.input_controller,
    )


@flow_of.register
def _(network: AdderGraph) -> Flow:
    steps: list[Step] = [Carried(f"{network.inputs} x", SIGNAL)]
    for n, (matrix, activations) in enumerate(
        zip(network.layers, network.activations, strict=False)
    ):
        steps += [matrix, Carried(f"{len(matrix.weights)} q", matrix.out_fmt)]
        if activations:
            steps += [Alike(network.tables(n)), Carried(f"{len(activations)} r", RESULT)]
    outputs = network.layers[-1]
    steps += [outputs, Carried(f"{network.outputs} y", outputs.out_fmt)]
    return Flow(tuple(steps), across=True)


@flow_of.register
def _(network: Engine) -> Flow:
    _, select, accumulate = network.steps
    return Flow(
        (
            Carried(f"{network.inputs} x", SIGNAL),
            network.round_saturate,
            Carried("samples, results", WORD),
            network.operand_memory,
            Carried("a word", WORD),
            select,
            Carried("an operand", WORD),
            accumulate,
            Carried(f"{network.outputs} y", SIGNAL),
        ),
        watcher=network.frame_guard if network.loaded else network.frame_check,
    )


@flow_of.register
def _(network: Lanes) -> Flow:
    return Flow(
        (
            Carried(f"{network.inputs} x", SIGNAL),
            network.rounds[0],
            Carried("samples, results", WORD),
            network.operand_memory,
            Carried(f"a word in each of {network.lanes} lanes", WORD),
            network.lane_memories[0],
            Carried("a coefficient in each lane", WORD),
            network.accumulators[0],
            Carried(f"{network.outputs} y", SIGNAL),
        ),
        watcher=network.frame_guard if network.loaded else network.frame_check,
    )


@flow_of.register
def _(network: Multiple) -> Flow:
    return Flow(
        (
            Carried("samples", SIGNAL),
            Beside(network.networks),
            Carried("every y", SIGNAL),
            network.output_collector,
            Carried("outputs", SIGNAL),
        )
    )


@flow_of.register
def _(network: Cascade) -> Flow:
    steps: list[Step] = [Carried(f"frames of {network.input_controller.inputs} elements", SIGNAL)]
    if network.frame_store:
        steps += [Controlled(network.input_controller, network.frame_store)]
        steps += [Carried("good frames", SIGNAL)]
    for member, multiplexer in zip(network.networks, network.multiplexers, strict=False):
        steps += [member, None, multiplexer, Carried(f"y in slot {multiplexer.slot}", SIGNAL)]
    steps += [network.networks[-1], Carried("every y", SIGNAL)]
    steps += [network.output_collector, Carried("outputs", SIGNAL)]
    return Flow(tuple(steps), watcher=None if network.frame_store else network.input_controller)


@flow_of.register
def _(network: Windowed) -> Flow:
    return Flow(
        (
            Carried(f"{network.inputs} x", SIGNAL),
            network.frame_window,
            Carried(f"{network.network.inputs} x, past and present", SIGNAL),
            network.network,
            Carried(f"{network.outputs} y", SIGNAL),
        )
    )


@flow_of.register
def _(network: AxisNetwork) -> Flow:
    return Flow((Carried("s_axis", TDATA), network.network, Carried("m_axis", TDATA)))
