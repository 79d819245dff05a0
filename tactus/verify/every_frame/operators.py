"""The cells of Yosys' netlist as functions of whole numbers.

The same text serves numbers, arrays, and what is linear of sums.
"""

import operator
from collections.abc import Callable
from typing import Any


def _parity(a: Any) -> Any:
    for shift in (32, 16, 8, 4, 2, 1):
        a = a ^ (a >> shift)
    return a & 1


CELLS: dict[str, Callable[..., Any]] = {
    "$not": operator.invert,
    "$neg": operator.neg,
    "$add": operator.add,
    "$sub": operator.sub,
    "$mul": operator.mul,
    "$and": operator.and_,
    "$or": operator.or_,
    "$xor": operator.xor,
    "$xnor": lambda a, b: ~(a ^ b),
    "$eq": operator.eq,
    "$ne": operator.ne,
    "$lt": operator.lt,
    "$le": operator.le,
    "$gt": operator.gt,
    "$ge": operator.ge,
    "$logic_not": lambda a: a == 0,
    "$logic_and": lambda a, b: (a != 0) & (b != 0),
    "$logic_or": lambda a, b: (a != 0) | (b != 0),
    "$reduce_or": lambda a: a != 0,
    "$reduce_bool": lambda a: a != 0,
    # Of an operand that is read with a sign.
    "$reduce_and": lambda a: a == -1,
    "$reduce_xor": _parity,
    "$reduce_xnor": lambda a: 1 - _parity(a),
}
LINEAR = "$add", "$sub", "$neg", "$not"
# Operands of these count modulo 2^n, n the width of the result; the others need the number itself.
MODULAR = *LINEAR, "$mul", "$and", "$or", "$xor", "$xnor"
COMPARISONS = "$eq", "$ne", "$lt", "$le", "$gt", "$ge"


def read_signed(kind: str, declared: bool) -> bool:
    """Whether operands are read with a sign, if all of them are declared so or not."""
    return kind == "$reduce_and" or (declared and kind in (*MODULAR, *COMPARISONS))


def signed(v: Any, width: int) -> Any:
    """The lowest bits as a number with a sign."""
    half = 1 << width - 1
    return (v + half) % (2 * half) - half
