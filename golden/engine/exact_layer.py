"""One layer of a network in exact numbers, on its way into whole numbers, and its operands."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

from golden.engine.grid import Grid
from golden.fixed import Fix
from golden.function import Function


@dataclass(frozen=True)
class Value:
    """A word that a layer takes as an operand.

    Parameters
    ----------
    node : int
        The input of the layer to which it belongs. A node with leaky ReLU has two words.
    factor : Fraction
        The factor by which the weights of that input are multiplied.
    fmt : Fix
    low, high : int
        The least and the largest code.
    earlier : bool
        Whether it is an output of an earlier network.
    """

    node: int
    factor: Fraction
    fmt: Fix
    low: int
    high: int
    earlier: bool = False


@dataclass(frozen=True)
class Exact:
    """One layer of a network, with numbers that are not rounded.

    Parameters
    ----------
    number : int
        Which layer of the network it is.
    activation : str
        "table", "relu", "leaky_relu", "hard_tanh" or "linear"; "sums" of those that later functions
        take.
    leak : Fraction
    weights : list of list of Fraction
        A list for each node, with a weight for each node of the layer before.
    biases : list of Fraction
    grid : Grid or None
        The grid of a layer with a quantiser.
    functions : tuple of Function
        Of a "table", the function of each node.
    output : bool
        Whether it is the last layer.
    added : list of lists of pairs of int and Function
        For each node the functions of operands that are added to its sum; empty for none.
    """

    number: int
    activation: str
    leak: Fraction
    weights: list[list[Fraction]]
    biases: list[Fraction]
    grid: Grid | None
    functions: tuple[Function, ...]
    output: bool
    added: list[list[tuple[int, Function]]] = field(default_factory=list)
