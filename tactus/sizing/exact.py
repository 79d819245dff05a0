"""Multipliers and block RAMs of a network: they are counted and not estimated.

Yosys makes the same of each block, whatever stands around it, so a count of its products and of
its memories is exact; ``tests/test_sizing.py`` compares it with every recorded synthesis.
"""

from collections.abc import Callable
from typing import Any

from golden.common.block import Block
from golden.engine.program_memory import ProgramMemory
from golden.input_error import InputError

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


def _neuron(block: Any) -> int:
    weights = [weight for weight in block.weights if weight] or [0]
    return sum(map(product, weights)) + product(block.factor or 1)


def _output_integral(block: Any) -> int:
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
    "neuron": _neuron,
    "output_integral": _output_integral,
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
