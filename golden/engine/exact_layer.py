"""One layer of a network in exact numbers, on its way into whole numbers, and its operands."""

from dataclasses import dataclass, field
from fractions import Fraction

from golden.engine.grid import Grid
from golden.numbers.fixed import Fix
from golden.trained.function import Function


@dataclass(frozen=True)
class Value:
    """A word that a layer takes as an operand.

    node: The input of the layer to which it belongs. A node with leaky ReLU has two words.
    factor: The factor by which the weights of that input are multiplied.
    low, high: The least and the largest code.
    earlier: Whether it is an output of an earlier network.
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

    number: Which layer of the network it is.
    activation: "table", "relu", "leaky_relu", "hard_tanh" or "linear"; "sums" of those that later
        functions take.
    weights: A list for each node, with a weight for each node of the layer before.
    grid: The grid of a layer with a quantiser.
    functions: Of a "table", the function of each node.
    output: Whether it is the last layer.
    added: For each node the functions of operands that are added to its sum; empty for none.
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
