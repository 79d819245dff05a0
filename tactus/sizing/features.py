"""What the cells of a network depend on, as its twin knows it.

Multipliers and block RAMs are counted and not estimated: Yosys makes the same of each block,
whatever stands around it. ``tests/test_sizing.py`` compares them with every recorded synthesis.
LUTs and flip-flops are estimated.

Each function here describes one kind of block by a few numbers, and a network has the sums of those
of its blocks. ``tactus.sizing.model`` fits how many cells each of them costs. What is so small that
no figure of a network shows it, such as a controller, has no number.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from golden.common.block import Block
from golden.engine.program_memory import ProgramMemory
from golden.input_error import InputError
from golden.layers.constant_matrix import ConstantMatrix
from golden.layers.input_integral import InputIntegral, InputNode
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
    "bipartite": lambda block, *_: 2 * (block.memory == "block_ram"),
    "bipartite_pair": lambda block, *_: 2 * (block.activation.memory == "block_ram"),
    "engine": _alone,
    "lane_memory": _weights,
    "operand_memory": lambda block, _words, _each, logic: int(block.addr_width > logic),
    "precise": lambda block, *_: int(block.coefficients == "block_ram"),
    "program_memory": _program,
}


# Numbers by name. Those on which both kinds of cells depend: how many nodes have an activation, and
# how many networks a cascade has, engines there are, and multipliers they have.
BOTH = ("bipartite", "gradient", "lut", "precise", "cascade", "engine", "lanes")
# What takes about a LUT each, as a bit of an adder does; bits that are rounded, those of a matrix
# that saturate, those of an adder of three operands; what chooses between more than two LUTs of a
# table; thresholds of activations; and of an engine: the lanes that look up, the words of a program
# in logic, and the sums of other lanes and the parts of a long memory, between which is chosen.
LUTS = (
    *(*BOTH, "luts", "rounded", "saturated", "three", "choices", "thresholds"),
    *("looked_up", "words", "partners", "parts"),
)
# Bits of registers, and the registers behind the memories of an engine.
FLIP_FLOPS = (*BOTH, "registers", "deep")
# These are described, and synthesised, as a whole. Entity by entity, Yosys packs the choice of the
# sum that a lane adds into wide multiplexers, and takes up to twice the LUTs.
IN_ONE_PIECE = ("engine",)
# The words of 4 bits that a block RAM holds. Up to so many words of a memory, each block RAM has
# some bits of every word, and nothing is chosen.
NARROW_WORDS = 4096
Features = Counter[str]
# Inputs of a LUT.
INPUTS = 4
Bits = NDArray[np.bool_]
# A function of an address at each address, whose bits are 0 or 1.
Column = tuple[int, ...]


def features_of(block: Block) -> Features:
    """The numbers by which the cells of a block and its parts are estimated; none of them is 0."""
    if block.block not in _FEATURES:
        raise InputError(f"{block.entity}: got a block {block.block!r}, whose cells have no model")
    found = Counter(_FEATURES[block.block](block))
    if block.block not in IN_ONE_PIECE:
        for part in block.parts():
            found.update(features_of(part))
    return +found


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


def bit_columns(words: Iterable[int], width: int) -> list[Column]:
    """The different bits of the words of a table as functions of its address, none constant.

    At addresses without a word the last one stands.
    """
    known = list(words)
    known += known[-1:] * ((1 << (len(known) - 1).bit_length()) - len(known))
    found = np.array(known, dtype=object)
    columns = {tuple((found >> bit & 1).tolist()) for bit in range(width)}
    return [one for one in sorted(columns) if len(set(one)) > 1]


# The same tables stand in graphs with other registers.
@lru_cache(maxsize=4096)
def luts_of(column: Column) -> tuple[int, int]:
    """The LUTs of a function of an address, and 1 if more than two LUTs are chosen between, else 0.

    A function of four address bits is a LUT, and one that is a bit of the address takes none. One
    of more is split by the address bits that choose between its LUTs; those bits are taken that
    leave the fewest. The choice between two LUTs is a wide multiplexer of their slice and takes no
    LUT. One of more does not always fit there; how many LUTs it takes is fitted.
    """
    bits = len(column).bit_length() - 1
    reduced = _needed(np.array(column, dtype=bool).reshape((2,) * bits))
    chosen = max(0, reduced.ndim - INPUTS)
    splits = combinations(range(reduced.ndim), chosen)
    return min(_parts(reduced, axes) for axes in splits), int(chosen > 1)


def _needed(cube: Bits) -> Bits:
    """A function without the address bits that it does not depend on."""
    for axis in reversed(range(cube.ndim)):
        low, high = np.split(cube, 2, axis)
        if (low == high).all():
            cube = low.squeeze(axis)
    return cube


def _parts(cube: Bits, axes: tuple[int, ...]) -> int:
    """The different functions between which some address bits choose, that take a LUT each."""
    moved = np.moveaxis(cube, axes, range(len(axes))).reshape(1 << len(axes), -1)
    different = np.unique(moved, axis=0)
    inputs = cube.ndim - len(axes)
    return sum(_needed(one.reshape((2,) * inputs)).ndim > 1 for one in different)


def _neuron(block: Any) -> dict[str, int]:
    spec: Neuron = block
    # A product has no more bits than its largest value needs.
    widths = [
        spec.in_fmt.width + abs(weight).bit_length() - spec.product_shift
        for weight in spec.weights
        if weight
    ]
    bias = spec.coeff_fmt.width + spec.bias_shift
    adders, registers = tree_bits([*widths, bias], spec.acc_width, constant=True)
    scaled = spec.scaled_width if spec.factor is not None else 0
    held = sum(widths) + registers + scaled + spec.out_fmt.width
    return {"luts": adders + scaled, "rounded": _rounded(spec), "registers": held}


def _rounded(spec: Any) -> int:
    return spec.acc_width - spec.out_shift if spec.out_shift else 0


def _input_integral(block: Any) -> dict[str, int]:
    spec: InputIntegral = block
    # All nodes have the same address, so equal columns are one.
    words = [
        sum(word << spec.coeff_fmt.width * j for j, word in enumerate(_unsigned(spec, column)))
        for column in zip(*spec.weights, strict=True)
    ]
    return {"luts": _table(words, spec.coeff_fmt.width * spec.hidden, spec.addr_width)}


def _table(words: Iterable[int], width: int, addr_width: int) -> int:
    found = bit_columns(words, width)
    # The bits of many weights are like random ones, for which no LUT can be left out.
    if addr_width > INPUTS:
        return len(found) << addr_width - INPUTS
    return sum(luts_of(column)[0] for column in found)


def _unsigned(spec: Any, words: Iterable[int]) -> list[int]:
    return [word & ((1 << spec.coeff_fmt.width) - 1) for word in words]


def _input_node(block: Any) -> dict[str, int]:
    spec: InputNode = block
    product = spec.in_fmt.width + spec.coeff_fmt.width
    # The LUTs of an adder choose between its sum and the bias as well, unless an exact product is
    # as wide as the sum.
    chosen = spec.acc_width * (not spec.product_shift and spec.acc_width <= product)
    held = product + product - spec.product_shift + spec.acc_width + spec.out_fmt.width
    return {"luts": spec.acc_width + chosen, "rounded": _rounded(spec), "registers": held}


def _output_integral(block: Any) -> dict[str, int]:
    spec: OutputIntegral = block
    term = spec.in_fmt.width + spec.coeff_fmt.width - spec.product_shift
    bias = spec.coeff_fmt.width + spec.bias_shift
    alone = spec.outputs == 1
    terms = [*[term] * spec.hidden, bias]
    adders, registers = tree_bits(terms, spec.acc_width, constant=alone)
    rows = [] if alone else [*zip(*spec.weights, strict=True), spec.biases]
    width = spec.coeff_fmt.width
    words = sum(_table(_unsigned(spec, row), width, spec.addr_width) for row in rows)
    scaled = spec.scaled_width if spec.factors is not None else 0
    held = spec.hidden * (spec.in_fmt.width + term) + registers
    return {"luts": adders + words + scaled, "rounded": _rounded(spec), "registers": held}


def _constant_matrix(block: Any) -> dict[str, int]:
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
    # An adder that is not shifted takes in more of what is behind it.
    finish = "rounded" if _adds_alone(spec) else "saturated"
    return {"luts": two, "three": three, finish: saturated, "registers": registers + sum(widths)}


def _adds_alone(matrix: ConstantMatrix) -> bool:
    """Whether no sample is multiplied by anything, except by one power of two for all."""
    weights = {weight for row in matrix.weights for weight in row if weight}
    return len(weights) < 2 and all(weight > 0 and not weight & weight - 1 for weight in weights)


def _bipartite(nodes: int, activation: Any) -> dict[str, int]:
    if activation.memory == "block_ram":
        return {"bipartite": nodes}
    # A LUT holds 16 bits of a table; a word that is 0 takes none.
    bits = sum(map(bool, activation.bases)) * activation.formats.base_width
    bits += sum(map(bool, activation.corrections)) * activation.table.correction_width
    return {"bipartite": nodes, "luts": nodes * bits >> INPUTS}


def _precise(block: Any) -> dict[str, int]:
    # A word in logic takes about two.
    return {"precise": 1, "luts": 2 * block.words * (block.coefficients == "logic")}


def _engine(block: Any) -> dict[str, int]:
    program, lanes = block.program_memory, block.lanes
    # Between the parts of one memory for all there is a choice.
    parts = (2 << block.program.row_bits) // NARROW_WORDS if block.alone else 1
    return {
        "engine": 1,
        "lanes": lanes,
        "looked_up": lanes * block.looks_up,
        "words": len(program.words) * (not block.alone and in_logic(program)),
        "partners": sum(max(0, one.partners - 1) for one in block.accumulators),
        "parts": max(0, parts - 1),
        "deep": block.program.pipeline.memory_registers,
    }


def _table_graph(block: Any) -> dict[str, int]:
    # No import of the design here: what reads a scene would depend on all that its twin imports.
    columns = [
        column
        for table in (*block.first, *block.second)
        for column in bit_columns(table.words, table.width)
    ]
    luts, choices = map(sum, zip(*map(luts_of, columns), strict=True))
    return {"luts": luts, "choices": choices, "registers": len(columns) + block.latency}


def _bits(width: int) -> dict[str, int]:
    return {"luts": width, "registers": width}


def _nothing(_: Block) -> dict[str, int]:
    return {}


# The largest output is found beside the networks, which are compared without it.
_SMALL = (
    *("adder_graph", "argmax_tree", "g_memory", "grad_eqn", "hybrid", "i_memory", "multiple"),
    *("input_controller", "output_controller", "parallel", "stream_multiplexer"),
)
_FEATURES: dict[str, Callable[[Any], dict[str, int]]] = {
    **dict.fromkeys(_SMALL, _nothing),
    "abs_unit": lambda block: _bits(block.fmt.width),
    "bipartite": lambda block: _bipartite(1, block),
    "bipartite_pair": lambda block: _bipartite(2, block.activation),
    "cascade": lambda block: {"cascade": len(block.networks)},
    "comparator_bank": lambda block: {"thresholds": len(block.thresholds)},
    "constant_matrix": _constant_matrix,
    "engine": _engine,
    "gradient": lambda _: {"gradient": 1},
    "input_integral": _input_integral,
    "input_node": _input_node,
    "lut": lambda _: {"lut": 1},
    "neuron": _neuron,
    "output_collector": lambda block: _bits(block.fmt.width * block.outputs),
    "output_integral": _output_integral,
    "precise": _precise,
    "sign_retriever": lambda block: _bits(block.fmt.width),
    "table_graph": _table_graph,
}
