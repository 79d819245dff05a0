"""What the LUTs and the flip-flops of a block depend on, as its twin knows it.

Each function here describes one kind of block by a few numbers: sums of widths of adders, of
registers, of words in LUTs. ``tactus.sizing.model`` fits how many cells each of them costs.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from golden.common.block import Block
from golden.engine.program_memory import ProgramMemory
from golden.input_error import InputError
from golden.layers.constant_matrix import ConstantMatrix
from golden.layers.input_integral import InputIntegral
from golden.layers.input_node import InputNode
from golden.layers.neuron import Neuron
from golden.layers.output_integral import OutputIntegral
from golden.layers.shift_add import Constant, Sum
from tactus.sizing.table_luts import bit_columns, luts_of

# The words of 9 bits that a block RAM holds.
NARROW_WORDS = 2048
# Up to so many bits of its address, a memory is built of LUTs.
LOGIC_ADDR_WIDTH = 6
# The cells of these blocks are measured flattened. Entity by entity, Yosys packs the choice of the
# sum that a lane adds into wide multiplexers, and takes up to twice the LUTs.
IN_ONE_PIECE = ("engine",)
# Blocks that differ only in how many nodes they serve have their costs together.
ALIKE = {"bipartite_pair": "bipartite"}
# A matrix that adds words up, without a product, has costs of its own: an adder that is not
# shifted takes in more of what is before and behind it.
PLAIN_SUMS = "constant_matrix of sums"

Numbers = tuple[float, ...]


@dataclass(frozen=True)
class Features:
    """What the own cells of a block depend on.

    luts, flip_flops: The numbers for each, in an order of the block's kind.
    """

    luts: Numbers
    flip_flops: Numbers


def group_of(block: Block) -> str:
    """The name under which the costs of a block are fitted."""
    if isinstance(block, ConstantMatrix) and _adds_alone(block):
        return PLAIN_SUMS
    return ALIKE.get(block.block, block.block)


def _adds_alone(matrix: ConstantMatrix) -> bool:
    """Whether no sample is multiplied by anything, except by one power of two for all."""
    weights = {weight for row in matrix.weights for weight in row if weight}
    return len(weights) < 2 and all(weight > 0 and not weight & weight - 1 for weight in weights)


def features_of(block: Block) -> Features:
    """The numbers by which the own cells of a block, without its parts, are estimated."""
    if block.block not in _FEATURES:
        raise InputError(f"{block.entity}: got a block {block.block!r}, whose cells have no model")
    return _FEATURES[block.block](block)


# Words of 18 bits in a block RAM.
HALF_BLOCK = 1024


def in_logic(program: ProgramMemory) -> bool:
    """Whether a program is so short, and without a table, that its memory is made of LUTs."""
    return program.addr_width <= LOGIC_ADDR_WIDTH


def columns(words: Iterable[int], width: int, addr_width: int) -> int:
    """How many LUTs a table of a few words takes: one for each column of bits that is its own.

    A column that is constant, or that is a bit of the address, takes none.
    """
    known = list(words)
    found = {tuple(word >> bit & 1 for word in known) for bit in range(width)}
    for bit in range(addr_width):
        found.discard(tuple(place >> bit & 1 for place in range(len(known))))
    return sum(len(set(column)) > 1 for column in found)


def tree_bits(widths: Sequence[int], most: int, constant: bool) -> tuple[int, int]:
    """The bits of all adders of an adder tree, and those of its registers.

    With ``constant`` the last term is a constant. To add it costs no LUT, because the carry chain
    takes the other operand as it is or inverted.
    """
    level, adders, registers = list(widths), 0, 0
    while len(level) > 1:
        wider = most if len(level) == 2 else min(most, max(level) + 1)
        pairs, odd = divmod(len(level), 2)
        adders += (pairs - (constant and not odd)) * wider
        registers += pairs * wider + odd * (not constant) * level[-1]
        constant = constant and bool(odd)
        level = [wider] * (pairs + odd)
    return adders, registers


def _both(*numbers: float) -> Features:
    """The same numbers for LUTs and for flip-flops."""
    return Features(numbers, numbers)


def _one(_: Block) -> Features:
    return _both(1)


def _neuron(block: Any) -> Features:
    spec: Neuron = block
    # A product has no more bits than its largest value needs.
    widths = [
        spec.in_fmt.width + abs(weight).bit_length() - spec.product_shift
        for weight in spec.weights
        if weight
    ]
    bias = spec.coeff_fmt.width + spec.bias_shift
    adders, registers = tree_bits([*widths, bias], spec.acc_width, constant=True)
    rounded = spec.acc_width - spec.out_shift if spec.out_shift else 0
    scaled = spec.scaled_width if spec.factor is not None else 0
    held = sum(widths) + registers + scaled + spec.out_fmt.width
    return Features((adders, rounded, scaled), (held,))


def _input_integral(block: Any) -> Features:
    spec: InputIntegral = block
    # All nodes have the same address, so equal columns are one.
    words = [
        sum(word << spec.coeff_fmt.width * j for j, word in enumerate(_unsigned(spec, column)))
        for column in zip(*spec.weights, strict=True)
    ]
    return _both(columns(words, spec.coeff_fmt.width * spec.hidden, spec.addr_width))


def _unsigned(spec: Any, words: Iterable[int]) -> list[int]:
    return [word & ((1 << spec.coeff_fmt.width) - 1) for word in words]


def _input_node(block: Any) -> Features:
    spec: InputNode = block
    product = spec.in_fmt.width + spec.coeff_fmt.width
    held = product + product - spec.product_shift + spec.acc_width + spec.out_fmt.width
    return Features((spec.acc_width, spec.out_shift > 0), (held,))


def _output_integral(block: Any) -> Features:
    spec: OutputIntegral = block
    term = spec.in_fmt.width + spec.coeff_fmt.width - spec.product_shift
    bias = spec.coeff_fmt.width + spec.bias_shift
    alone = spec.outputs == 1
    terms = [*[term] * spec.hidden, bias]
    adders, registers = tree_bits(terms, spec.acc_width, constant=alone)
    rows = [] if alone else [*zip(*spec.weights, strict=True), spec.biases]
    width = spec.coeff_fmt.width
    words = sum(columns(_unsigned(spec, row), width, spec.addr_width) for row in rows)
    scaled = spec.scaled_width if spec.factors is not None else 0
    rounded = spec.acc_width - spec.out_shift if spec.out_shift else 0
    products = spec.hidden * (spec.in_fmt.width + term)
    return Features((adders, words, rounded, scaled), (products, registers, words))


def _constant_matrix(block: Any) -> Features:
    spec: ConstantMatrix = block
    graph, clocks = spec.graph, spec.clocks
    needed = list(clocks)
    two = three = 0
    for place, node in enumerate(graph.nodes):
        if not isinstance(node, Sum):
            continue
        for one in node.operands:
            needed[one.node] = max(needed[one.node], clocks[place])
        if len(node.operands) > 2:
            three += graph.bits(place)
        elif not any(isinstance(graph.nodes[one.node], Constant) for one in node.operands):
            # Bits below an operand that is shifted left pass or are inverted.
            two += max(0, graph.widths[place] - max(step.move for step in graph.steps(place)))
    for row in graph.rows:
        needed[row.node] = max(needed[row.node], spec.latency - 1)
    registers = sum(
        graph.widths[place] * (needed[place] - clocks[place])
        for place, node in enumerate(graph.nodes)
        if not isinstance(node, Constant)
    )
    # Bits below a sum that is moved left are always 0.
    empty = [max(0, -spec.drop(row)) for row in graph.rows]
    pairs = zip(spec.result_widths, empty, strict=True)
    widths = [min(spec.out_fmt.width, width) - below for width, below in pairs]
    # What is rectified becomes 0 by the reset of its register, and so does half of saturation.
    saturated = sum(
        kept
        for kept, width, below, kind in zip(
            widths, spec.result_widths, empty, spec.row_finishes, strict=True
        )
        if width - below > kept and not kind.rectified
    )
    return Features((two, three, saturated), (registers + sum(widths),))


def _bipartite(nodes: int) -> Callable[[Any], Features]:
    def found(block: Any) -> Features:
        activation = block if nodes == 1 else block.activation
        logic = activation.memory != "block_ram"
        words = len(activation.bases) + len(activation.corrections) if logic else 0
        return _both(nodes, nodes * activation.reach_width, words)

    return found


def _precise(block: Any) -> Features:
    logic = block.coefficients == "logic"
    return Features((1, logic * block.words), (1,))


def _input_controller(block: Any) -> Features:
    return _both(1, (block.inputs - 1).bit_length(), block.spacing.bit_length())


def _lanes(block: Any) -> Features:
    program, lanes, looked_up = block.program_memory, block.lanes, block.lanes * block.looks_up
    words = len(program.words) * (not block.alone and in_logic(program))
    # What chooses between the sums of other lanes.
    choices = sum(max(0, one.partners - 1) for one in block.accumulators)
    # Between the block RAMs of one memory for all there is a choice.
    more = (2 << block.program.row_bits) // HALF_BLOCK - 1 if block.alone else 0
    return Features((1, lanes, looked_up, words, choices, max(0, more)), (1, lanes, words))


def _table_graph(block: Any) -> Features:
    # No import of the design here: what reads a scene would depend on all that its twin imports.
    columns = [
        column
        for table in (*block.first, *block.second)
        for column in bit_columns(table.words, table.width)
    ]
    luts, choices = map(sum, zip(*map(luts_of, columns), strict=True))
    return Features((luts, choices), (len(columns) + block.latency,))


def _program_memory(block: Any) -> Features:
    # Up to so many words, each block RAM has some bits of every word, and nothing is chosen.
    chosen = max(0, (1 << block.addr_width) // NARROW_WORDS - 1)
    return Features((1, chosen), (1, block.addr_width, block.registers))


_FEATURES: dict[str, Callable[[Any], Features]] = {
    "abs_unit": lambda block: _both(1, block.fmt.width),
    "adder_graph": lambda block: _both(1, block.latency),
    "bipartite": _bipartite(1),
    "bipartite_pair": _bipartite(2),
    "cascade": lambda block: _both(1, len(block.networks)),
    "comparator_bank": lambda block: _both(1, len(block.thresholds)),
    "constant_matrix": _constant_matrix,
    "engine": _lanes,
    "frame_check": lambda block: _both(1, block.pipeline.memory_registers, block.addr_width),
    "g_memory": lambda block: _both(1, len(block.words)),
    "grad_eqn": _one,
    "gradient": _one,
    "hybrid": _one,
    "i_memory": lambda block: _both(1, len(block.words)),
    "input_controller": _input_controller,
    "input_integral": _input_integral,
    "input_node": _input_node,
    "lut": _one,
    "multiple": lambda block: _both(1, len(block.networks)),
    "neuron": _neuron,
    "operand_memory": lambda block: _both(1, block.registers),
    "output_collector": lambda block: _both(1, block.outputs),
    "output_controller": lambda block: _both(1, block.outputs > 1),
    "output_integral": _output_integral,
    "parallel": lambda block: _both(1, block.latency),
    "polynomial": _one,
    "precise": _precise,
    "program_memory": _program_memory,
    "sign_retriever": _one,
    "stream_multiplexer": _one,
    "table_graph": _table_graph,
}
