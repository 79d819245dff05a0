"""Expressions of x, as a scene writes them: Python's syntax, of which only arithmetic is allowed.

An expression is read into a tree, whose nodes are evaluated with numpy. No text is ever executed.
"""

import ast
import math
import operator
from collections.abc import Callable
from typing import Any

import numpy as np

from golden.input_error import InputError
from golden.numbers.real import Real

# A longer text could be nested more deeply than Python's parser allows.
MOST_CHARACTERS = 300
_erf = np.vectorize(math.erf, otypes=[np.float64])
# Each function with the number of its arguments.
FUNCTIONS: dict[str, tuple[Callable[..., Any], int]] = {
    "abs": (np.abs, 1),
    "sign": (np.sign, 1),
    "floor": (np.floor, 1),
    "sqrt": (np.sqrt, 1),
    "exp": (np.exp, 1),
    "log": (np.log, 1),
    "sin": (np.sin, 1),
    "cos": (np.cos, 1),
    "tan": (np.tan, 1),
    "sinh": (np.sinh, 1),
    "cosh": (np.cosh, 1),
    "tanh": (np.tanh, 1),
    "atan": (np.arctan, 1),
    "erf": (_erf, 1),
    "min": (np.minimum, 2),
    "max": (np.maximum, 2),
}
_NAMES = {"pi": math.pi, "e": math.e}
_OPERATORS: dict[type[ast.AST], Callable[..., Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}
_CALLS = ", ".join(f"{name}({', '.join('ab'[:n])})" for name, (_, n) in FUNCTIONS.items())
ALLOWED = f"numbers, x, pi, e, + - * / **, brackets, a if x < b else c, and {_CALLS}"


def evaluate(text: str, x: Real) -> Real:
    """The values of an expression at ``x``. Where it is not defined they are NaN or infinity."""
    if len(text) > MOST_CHARACTERS:
        raise InputError(f"got {len(text)} characters, expected {MOST_CHARACTERS} at most")
    try:
        tree = ast.parse(text.strip(), mode="eval")
        with np.errstate(all="ignore"):
            found = _value(tree.body, x)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise InputError(
            f"got {text!r}, expected an expression of x, such as 'x / (1 + abs(x))'"
        ) from None
    return np.broadcast_to(np.asarray(found, dtype=np.float64), np.shape(x)).copy()


def _value(node: ast.AST, x: Real) -> Any:
    """The value of a node of the tree: an array, or a number where x is not in it."""
    match node:
        case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
            # Python's own whole numbers could grow without limit.
            return np.float64(number)
        case ast.Name(id="x"):
            return x
        case ast.Name(id=name) if name in _NAMES:
            return np.float64(_NAMES[name])
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
            return _OPERATORS[type(op)](_value(left, x), _value(right, x))
        case ast.UnaryOp(op=op, operand=operand) if type(op) in _OPERATORS:
            return _OPERATORS[type(op)](_value(operand, x))
        case ast.IfExp(
            test=ast.Compare(left=left, ops=[op], comparators=[right]), body=body, orelse=orelse
        ) if type(op) in _OPERATORS:
            holds = _OPERATORS[type(op)](_value(left, x), _value(right, x))
            return np.where(holds, _value(body, x), _value(orelse, x))
        case ast.Call(func=ast.Name(id=name), args=args, keywords=[]) if name in FUNCTIONS:
            function, count = FUNCTIONS[name]
            if len(args) == count and not any(isinstance(arg, ast.Starred) for arg in args):
                return function(*(_value(arg, x) for arg in args))
    raise InputError(f"got {ast.unparse(node)!r}, expected {ALLOWED}")
