"""What the cells of a network depend on, as its twin knows it.

Multipliers and block RAMs are counted and not estimated: Yosys makes the same of each block,
whatever stands around it. ``tests/test_sizing.py`` compares them with every recorded synthesis.
LUTs and flip-flops are estimated.

Each function here describes one kind of block by a few numbers, and a network has the sums of those
of its blocks. ``tactus.sizing.model`` fits how many cells each of them costs. Only what is large
has numbers: adders, registers, tables, activations and lanes. The rest, such as rounding and
controllers, is part of the error that ``docs/designs.md`` states.
"""

from collections import Counter
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from golden.common.block import Block
from golden.engine.memories import ProgramMemory
from golden.input_error import InputError
from golden.layers.constant_matrix import ConstantMatrix
from golden.layers.input_integral import InputNode
from golden.layers.output_integral import OutputIntegral
from golden.layers.shift_add import Constant, Sum
from golden.networks.parallel import Neuron

# Words of 18 bits in a block RAM of a Virtex-II.
HALF_BLOCK = 1024
# Up to so many bits of its address, the memory of a program is built of LUTs.
LOGIC_ADDR_WIDTH = 6
# Words of 36 bits in a block RAM of a Virtex-II, and in the two of an ECP5 that have two read ports
# of 36 bits; and up to how many bits of its address a memory of operands is built of LUTs.
WORDS = {"xc2v": (512, 1, 4), "ecp5": (1024, 2, 6)}


def multipliers(top: Block) -> int:
    own = _MULTIPLIERS[top.block](top) if top.block in _MULTIPLIERS else 0
    return own + sum(map(multipliers, top.parts()))


def block_rams(top: Block, family: str) -> int:
    own = _MEMORIES[top.block](top, *WORDS[family]) if top.block in _MEMORIES else 0
    return own + sum(block_rams(part, family) for part in top.parts())


def in_logic(program: ProgramMemory) -> bool:
    """Whether a program is so short that its memory is made of LUTs."""
    return program.addr_width <= LOGIC_ADDR_WIDTH


def product(constant: int) -> int:
    """How many multipliers a product with a constant takes: none if it only moves bits."""
    return int(bin(abs(constant)).count("1") > 1)


def _neuron_products(block: Any) -> int:
    weights = [weight for weight in block.weights if weight] or [0]
    return sum(map(product, weights)) + product(block.factor or 1)


def _integral_products(block: Any) -> int:
    if block.outputs > 1:
        return int(block.hidden) + (block.factors is not None)
    factors = block.factors or (1,)
    return sum(map(product, block.weights[0])) + sum(map(product, factors))


def _not_counted(block: Block) -> int:
    raise InputError(
        f"{block.entity}: got activation {block.block!r}, whose multipliers depend on what Yosys "
        "makes of its products; make synth counts them"
    )


def _program(block: Any, *_: int) -> int:
    # One port of 36 bits is what a block RAM of either family has.
    words, each, _logic = WORDS["xc2v"]
    return 0 if in_logic(block) else max(1, (1 << int(block.addr_width)) // words) * each


def _weights(block: Any, *_: int) -> int:
    return max(1, (1 << int(block.addr_width)) // HALF_BLOCK)


def _alone(block: Any, *_: int) -> int:
    return max(1, (2 << block.program.row_bits) // HALF_BLOCK) if block.alone else 0


_MULTIPLIERS: dict[str, Callable[[Any], int]] = {
    "grad_eqn": lambda _: 1,
    "gradient_parallel": _not_counted,
    "input_node": lambda _: 1,
    "lane_accumulate": lambda _: 1,
    "lut": lambda _: 1,
    "neuron": _neuron_products,
    "output_integral": _integral_products,
    "pade": _not_counted,
    "polynomial": _not_counted,
    "precise": lambda _: 1,
}
_MEMORIES: dict[str, Callable[..., int]] = {
    "bipartite": lambda *_: 2,
    "bipartite_pair": lambda *_: 2,
    "engine": _alone,
    "lane_memory": _weights,
    "operand_memory": lambda block, _words, _each, logic: int(block.addr_width > logic),
    "precise": lambda block, *_: int(block.coefficients == "block_ram"),
    "program_memory": _program,
}


# Numbers by name. Those on which both kinds of cells depend: how many nodes have an activation, and
# how many networks a cascade has, engines there are, and multipliers they have.
BOTH = ("bipartite", "gradient", "lut", "precise", "cascade", "engine", "lanes")
# What takes about a LUT each, as a bit of an adder does; the lanes of an engine that look up, and
# the sums of other lanes between which is chosen.
LUTS = (*BOTH, "luts", "looked_up", "partners")
# Bits of registers, and the registers behind the memories of an engine.
FLIP_FLOPS = (*BOTH, "registers", "deep")
# These are described, and synthesised, as a whole. Entity by entity, Yosys packs the choice of the
# sum that a lane adds into wide multiplexers, and takes up to twice the LUTs.
IN_ONE_PIECE = ("engine",)
# The words of 4 bits that a block RAM holds. Up to so many words of a memory, each block RAM has
# some bits of every word, and nothing is chosen.
NARROW_WORDS, WORD_BITS = 4096, 18
# A LUT of four inputs holds so many bits of a table.
TABLE_BITS = 16
# A bit of a sum of three operands takes two LUTs that make two operands of them, and one that adds.
THREE_OPERANDS = 3
Features = Counter[str]


def features_of(block: Block) -> Features:
    """The numbers by which the cells of a block and its parts are estimated; none of them is 0."""
    if block.block not in _FEATURES:
        raise InputError(f"{block.entity}: got a block {block.block!r}, whose cells have no model")
    found = Counter(_FEATURES[block.block](block))
    if block.block not in IN_ONE_PIECE:
        for part in block.parts():
            found.update(features_of(part))
    return +found


def table_luts(words: Iterable[int], width: int) -> list[int]:
    """For each bit of the words that is not constant, how many LUTs its table takes.

    They are the different functions of the lowest four address bits, except constants. At addresses
    without a word the last one stands.
    """
    known = list(words)
    size = max(TABLE_BITS, 1 << (len(known) - 1).bit_length())
    whole = np.array(known + known[-1:] * (size - len(known)), dtype=object)
    bits = [(whole >> bit & 1).astype(bool).reshape(-1, TABLE_BITS) for bit in range(width)]
    return [
        sum(0 < sum(part) < TABLE_BITS for part in set(map(tuple, column)))
        for column in bits
        if column.any() and not column.all()
    ]


def _neuron(block: Any) -> dict[str, int]:
    spec: Neuron = block
    # A product has no more bits than its largest value needs.
    products = [
        spec.in_fmt.width + abs(weight).bit_length() - spec.product_shift
        for weight in spec.weights
        if weight
    ]
    return {"luts": sum(products), "registers": 2 * len(products) * spec.acc_width}


def _input_node(block: Any) -> dict[str, int]:
    spec: InputNode = block
    # An adder, whose LUTs choose between its sum and the bias; and registers of the product, the
    # product as it is added, the sum and the result.
    return {"luts": 2 * spec.acc_width, "registers": 4 * spec.acc_width}


def _weight_table(block: Any, rows: int) -> int:
    return rows * block.coeff_fmt.width * (1 << block.addr_width) // TABLE_BITS


def _output_integral(block: Any) -> dict[str, int]:
    spec: OutputIntegral = block
    words = _weight_table(spec, spec.hidden + 1) if spec.outputs > 1 else 0
    adders = spec.hidden * spec.acc_width
    return {"luts": adders + words, "registers": 2 * adders}


def _constant_matrix(block: Any) -> dict[str, int]:
    spec: ConstantMatrix = block
    graph, clocks = spec.graph, spec.clocks
    needed = list(clocks)
    adders = 0
    for place, node in enumerate(graph.nodes):
        if not isinstance(node, Sum):
            continue
        for one in node.operands:
            needed[one.node] = max(needed[one.node], clocks[place])
        if len(node.operands) > 2:
            adders += THREE_OPERANDS * graph.bits(place)
        elif not any(isinstance(graph.nodes[one.node], Constant) for one in node.operands):
            # To add a constant costs no LUT: the carry chain takes a number as it is or inverted.
            adders += graph.bits(place)
    for row in graph.rows:
        needed[row.node] = max(needed[row.node], spec.latency - 1)
    registers = sum(
        graph.widths[place] * (needed[place] - clocks[place])
        for place, node in enumerate(graph.nodes)
        if not isinstance(node, Constant)
    )
    width = spec.out_fmt.width
    # What is rectified becomes 0 by the reset of its register.
    saturated = sum(
        width * (wide > width and not finish.rectified)
        for wide, finish in zip(spec.result_widths, spec.row_finishes, strict=True)
    )
    return {"luts": adders + saturated, "registers": registers + width * len(spec.weights)}


def _precise(block: Any) -> dict[str, int]:
    # A word in logic takes about two.
    return {"precise": 1, "luts": 2 * block.words * (block.coefficients == "logic")}


def _engine(block: Any) -> dict[str, int]:
    program, lanes = block.program_memory, block.lanes
    parts = (2 << block.program.row_bits) // NARROW_WORDS if block.alone else 1
    chosen = WORD_BITS * max(0, parts - 1)
    return {
        "engine": 1,
        "lanes": lanes,
        "looked_up": lanes * block.looks_up,
        # The words of a program in logic take about a LUT each, and so do the bits of a word that
        # comes from one of several parts of a memory.
        "luts": len(program.words) * (not block.alone and in_logic(program)) + chosen,
        "partners": sum(max(0, one.partners - 1) for one in block.accumulators),
        "deep": block.program.pipeline.memory_registers,
    }


def _table_graph(block: Any) -> dict[str, int]:
    # No import of the design here: what reads a scene would depend on all that its twin imports.
    tables = (*block.first, *block.second)
    luts = [count for table in tables for count in table_luts(table.words, table.width)]
    return {"luts": sum(luts), "registers": len(luts) + block.latency}


def _bits(width: int) -> dict[str, int]:
    return {"luts": width, "registers": width}


# The largest output is found beside the networks, which are compared without it.
_SMALL = (
    *("adder_graph", "argmax_tree", "comparator_bank", "g_memory", "grad_eqn", "hybrid"),
    *("i_memory", "input_controller", "multiple", "output_controller", "parallel"),
    "stream_multiplexer",
)
_FEATURES: dict[str, Callable[[Any], dict[str, int]]] = {
    **dict.fromkeys(_SMALL, lambda _: {}),
    "abs_unit": lambda block: _bits(block.fmt.width),
    "bipartite": lambda _: {"bipartite": 1},
    "bipartite_pair": lambda _: {"bipartite": 2},
    "cascade": lambda block: {"cascade": len(block.networks)},
    "constant_matrix": _constant_matrix,
    "engine": _engine,
    "gradient": lambda _: {"gradient": 1},
    "input_integral": lambda block: {"luts": _weight_table(block, block.hidden)},
    "input_node": _input_node,
    "lut": lambda _: {"lut": 1},
    "neuron": _neuron,
    "output_collector": lambda block: _bits(block.fmt.width * block.outputs),
    "output_integral": _output_integral,
    "precise": _precise,
    "sign_retriever": lambda block: _bits(block.fmt.width),
    "table_graph": _table_graph,
}
