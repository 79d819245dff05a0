"""The cells of Yosys' netlist as functions of whole numbers. The same text serves numbers and
arrays."""

from collections.abc import Callable
from typing import Any

import numpy as np


def parity(a: Any) -> Any:
    for shift in (32, 16, 8, 4, 2, 1):
        a = a ^ (a >> shift)
    return a & 1


# Of one operand: its value a and its width n.
ONE: dict[str, Callable[[Any, int], Any]] = {
    "$not": lambda a, n: ~a,
    "$neg": lambda a, n: -a,
    "$logic_not": lambda a, n: a == 0,
    "$reduce_or": lambda a, n: a != 0,
    "$reduce_bool": lambda a, n: a != 0,
    "$reduce_and": lambda a, n: a == (1 << n) - 1,
    "$reduce_xor": lambda a, n: parity(a),
    "$reduce_xnor": lambda a, n: 1 - parity(a),
}
TWO: dict[str, Callable[[Any, Any], Any]] = {
    "$add": lambda a, b: a + b,
    "$sub": lambda a, b: a - b,
    "$mul": lambda a, b: a * b,
    "$and": lambda a, b: a & b,
    "$or": lambda a, b: a | b,
    "$xor": lambda a, b: a ^ b,
    "$xnor": lambda a, b: ~(a ^ b),
    "$eq": lambda a, b: a == b,
    "$ne": lambda a, b: a != b,
    "$lt": lambda a, b: a < b,
    "$le": lambda a, b: a <= b,
    "$gt": lambda a, b: a > b,
    "$ge": lambda a, b: a >= b,
    "$logic_and": lambda a, b: (a != 0) & (b != 0),
    "$logic_or": lambda a, b: (a != 0) | (b != 0),
}
# Operands of these count modulo 2^n, n the width of the result; the others need the number itself.
MODULAR = "$add", "$sub", "$mul", "$neg", "$not", "$and", "$or", "$xor", "$xnor"
COMPARISONS = "$eq", "$ne", "$lt", "$le", "$gt", "$ge"
# An operand that is read without its sign, whatever the other is.
UNSIGNED = (*(kind for kind in ONE if kind not in MODULAR), "$logic_and", "$logic_or")


def signed(v: int, width: int) -> int:
    return v - (1 << width) if v >> width - 1 & 1 else v


def array(v: Any) -> Any:
    """A result as whole numbers: True is 1."""
    return v.astype(np.int64) if isinstance(v, np.ndarray | np.generic) else int(v)
