"""Texts about parts that a network does not need and its hardware therefore does not have."""

from collections import Counter
from collections.abc import Sequence
from functools import singledispatch

from golden.activation.activation_block import ActivationBlock
from golden.activation.bipartite import Bipartite
from golden.activation.bipartite_table import MAGNITUDE_WIDTH
from golden.activation.gradient import Gradient
from golden.activation.gradient_parallel import GradientParallel
from golden.activation.lut import DEPTH, Lut
from golden.activation.pade import Pade
from golden.activation.polynomial import UPPER as POLYNOMIAL_UPPER
from golden.activation.polynomial import Polynomial
from golden.activation.precise import Precise
from golden.activation.segments import UPPER
from golden.common.block import Block
from golden.networks.adder_graph import AdderGraph
from golden.networks.axis_network import AxisNetwork
from golden.networks.cascade import Cascade
from golden.networks.design import Design
from golden.networks.engine import WHOLE_ACC_WIDTH, Engine
from golden.networks.hybrid import Hybrid
from golden.networks.multiple import Several
from golden.networks.network import Network
from golden.networks.parallel import Parallel
from golden.networks.windowed import Windowed


@singledispatch
def left_out(block: Block) -> list[str]:
    """The texts for a network. A network around other networks has the texts of these."""
    inside = (part for part in block.parts() if isinstance(part, Network))
    return [text for part in inside for text in left_out(part)]


@left_out.register
def _(network: Several) -> list[str]:
    places: dict[str, list[str]] = {}
    for part in network.networks:
        for text in left_out(part):
            places.setdefault(text, []).append(part.entity)
    return [f"{', '.join(names)}: {text}" for text, names in places.items()]


@left_out.register
def _(network: Cascade) -> list[str]:
    texts = left_out.dispatch(Several)(network)
    if not network.frame_store:
        texts.append(f"{network.entity}: the memory that holds a frame until it is judged")
    return texts


@left_out.register
def _(network: Windowed) -> list[str]:
    texts = left_out(network.network)
    if not network.frame_window.spacing:
        texts.append(f"{network.frame_window.entity}: the counter that keeps frames apart")
    return texts


@left_out.register
def _(network: AxisNetwork) -> list[str]:
    texts = left_out(network.network)
    if not network.spacing:
        texts.append(f"{network.entity}: the counter that keeps frames apart")
    return texts


@left_out.register
def _(network: Hybrid) -> list[str]:
    texts = of_hidden_nodes(network, network.activations)
    if network.output_integral.factors is None:
        texts.append("the de-normalisation multiplier and its ROM")
    if not network.input_controller.spacing:
        texts.append("the counter that keeps frames apart: a frame has samples enough")
    return texts


@left_out.register
def _(network: Parallel) -> list[str]:
    texts = of_hidden_nodes(network, network.activations)
    zeros = sum(n.weights.count(0) for n in (*network.hidden_neurons, *network.output_neurons))
    if zeros:
        texts.append(f"{zeros} multipliers of weights that are 0")
    if network.output_neurons[0].factor is None:
        texts.append("the multipliers of the de-normalisation")
    if not network.input_controller.spacing:
        texts.append("the counter that keeps frames apart: one may come in every clock")
    return texts


@left_out.register
def _(network: AdderGraph) -> list[str]:
    tables = [table for tables in network.activations for table in tables]
    texts = of_hidden_nodes(network, tables)
    if network.constant_nodes:
        texts.append(f"{network.constant_nodes} hidden nodes that never change, now in biases")
    return [*texts, "every multiplier: a weight is a few shifted adds, shared with others"]


@left_out.register
def _(network: Engine) -> list[str]:
    # Each word that is left out saves memory, and each step saves a clock of every frame.
    graph = network.graph
    texts = of_useless_nodes(network)
    if graph.useless_terms:
        texts.append(f"{graph.useless_terms} products of weight 0")
    if network.asked > network.lanes:
        texts.append(f"{network.asked - network.lanes} lanes that no layer has a node for")
    bits = WHOLE_ACC_WIDTH - network.acc_width
    if bits > 0:
        which = "each sum" if network.lanes > 1 else "the sum"
        texts.append(f"{bits} bits of {which}, which {WHOLE_ACC_WIDTH} would hold for any scene")
    return texts


def of_hidden_nodes(network: Design, activations: Sequence[ActivationBlock]) -> list[str]:
    """Texts about parts that the activations lack in total, and about nodes that are not built."""
    counts: Counter[str] = sum(map(parts_left_out, activations), Counter())
    return [f"{n} {what}" for what, n in sorted(counts.items())] + of_useless_nodes(network)


def of_useless_nodes(network: Design) -> list[str]:
    """A text about hidden nodes that are not built, if there are any."""
    count = network.useless_nodes
    return [f"{count} hidden nodes whose weights to the outputs are 0"] if count else []


COMPARATORS = "comparators of segments no neuron reaches"
MULTIPLIERS = "multipliers of segments no neuron reaches"
ROM_WORDS = "ROM words of segments no neuron reaches"
TABLE_WORDS = "table words that no neuron reaches"


@singledispatch
def parts_left_out(_: ActivationBlock) -> Counter[str]:
    """How many parts of each kind the block lacks because the neuron cannot need them."""
    return Counter()


@parts_left_out.register
def _(block: Bipartite) -> Counter[str]:
    reached = block.words_within(min(block.reach_width, MAGNITUDE_WIDTH))
    return +Counter({TABLE_WORDS: block.words_within(MAGNITUDE_WIDTH) - reached})


@parts_left_out.register
def _(block: Gradient) -> Counter[str]:
    comparators = len(UPPER) - len(block.table.thresholds)
    # The word of what saturates comes with the last comparator.
    words = 2 * (len(UPPER) + 1 - len(block.table.coeffs)) if comparators else 0
    return +Counter({COMPARATORS: comparators, ROM_WORDS: words})


@parts_left_out.register
def _(block: GradientParallel) -> Counter[str]:
    comparators = len(UPPER) - len(block.table.thresholds)
    return +Counter({COMPARATORS: comparators, MULTIPLIERS: len(UPPER) - len(block.segments)})


@parts_left_out.register
def _(block: Lut) -> Counter[str]:
    words, comparators = DEPTH - len(block.words), 1 - len(block.thresholds)
    return +Counter({TABLE_WORDS: words, COMPARATORS: comparators})


@parts_left_out.register
def _(block: Pade) -> Counter[str]:
    return +Counter({COMPARATORS: 1 - len(block.thresholds)})


@parts_left_out.register
def _(block: Polynomial) -> Counter[str]:
    comparators = len(POLYNOMIAL_UPPER) - len(block.thresholds)
    words = 3 * (len(POLYNOMIAL_UPPER) - len(block.coeffs))
    return +Counter({COMPARATORS: comparators, ROM_WORDS: words})


@parts_left_out.register
def _(block: Precise) -> Counter[str]:
    return +Counter({ROM_WORDS: len(block.whole.intercepts) - block.words})
