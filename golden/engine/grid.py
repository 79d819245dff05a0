"""The grid of a quantiser in the words of an engine, which hold every code exactly.

A word is the difference between a code and the lowest code, shifted left until the highest code
fills the word. So the word saturates where the codes do, and its lowest bits are 0. All layers of a
network have the same number of such bits.

A step from code to code is a power of two here, whatever the scale of the quantiser is. ReLU and
linear layers allow that: if the weights and biases of a layer are multiplied by a factor, its
values are too, and the weights of the next layer are divided by it. Then the codes are the same. So
only the ratio of the scales of a sum and of the quantiser behind it matters.
"""

from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from numpy.typing import NDArray

from golden.engine.formats import WIDTH
from golden.engine.integer_network import LayerRounding
from golden.input_error import InputError
from golden.numbers.fixed import Fix
from golden.trained.dense import Dense
from golden.trained.function import Function

# At least one bit of a word is cut, and its highest bit is the sign.
MOST_BITS = WIDTH - 2
# Halves are rounded away from 0 only where no code is below it, so upwards.
ROUNDINGS = {"even": LayerRounding.EVEN, "away": LayerRounding.UP, "floor": LayerRounding.DOWN}
# What a scene may say where an exact network is not possible.
OR_NEAREST = ', or network.quantised = "nearest"'


@dataclass(frozen=True)
class Grid:
    """The quantiser behind a layer, in the terms of the engine.

    result: Format of the words, which are differences from the lowest code.
    cut: How many of the lowest bits of a word are 0.
    lowest: The value of the lowest code.
    factor: How many times the value in the file a value is here.
    nearest: Whether weights and biases that words do not hold exactly may be rounded.
    """

    result: Fix
    cut: int
    rounding: LayerRounding
    lowest: Fraction
    factor: Fraction = Fraction(1)
    nearest: bool = False

    @property
    def high(self) -> int:
        """The highest code, counted from the lowest."""
        return (1 << (WIDTH - 1 - self.cut)) - 1


def grid_of(layer: Dense) -> Grid | None:
    """The grid of a layer, or None if it has no quantiser."""
    quantiser = layer.quantiser
    if quantiser is None:
        return None
    if layer.activation not in ("relu", "linear"):
        raise InputError(
            f"got a quantiser behind {layer.activation}, expected one behind relu or linear, which "
            "are exact"
        )
    scale = Fraction(quantiser.scale)
    # The exponent of a power of two is exact.
    exponent = scale.numerator.bit_length() - scale.denominator.bit_length()
    step = Fraction(2) ** exponent
    low = max(quantiser.low, quantiser.zero) if layer.activation == "relu" else quantiser.low
    codes = quantiser.high - low + 1
    if codes < 2 or codes & (codes - 1) or codes > 1 << MOST_BITS:
        raise InputError(
            f"got {codes} codes, {low} to {quantiser.high}, expected a power of two, 2 to "
            f"{1 << MOST_BITS}: others would need a comparison"
        )
    rounded = low - (quantiser.zero if quantiser.before_zero else 0)
    if quantiser.rounding == "away" and rounded < 0 and not quantiser.nearest:
        raise InputError(
            f"got halves rounded away from 0 on both sides of it, expected to even{OR_NEAREST}"
        )
    if quantiser.rounding == "even" and rounded % 2 and not quantiser.nearest:
        raise InputError(
            f"got the zero point {quantiser.zero} with halves rounded to even, expected an even "
            f"one{OR_NEAREST}"
        )
    cut = WIDTH - 1 - (codes.bit_length() - 1)
    frac = cut - exponent
    if frac < 0:
        raise InputError(f"got the scale {quantiser.scale:g}, expected {2**cut} at most")
    return Grid(
        Fix(WIDTH, frac),
        cut,
        ROUNDINGS[quantiser.rounding],
        (low - quantiser.zero) * step,
        step / scale,
        quantiser.nearest,
    )


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
    weights, biases: Arrays of fractions; a row of weights for each node, with one for each node of
        the layer before.
    grid: The grid of a layer with a quantiser.
    functions: Of a "table", the function of each node.
    output: Whether it is the last layer.
    added: For each node the functions of operands that are added to its sum; empty for none.
    """

    number: int
    activation: str
    leak: Fraction
    weights: NDArray[Any]
    biases: NDArray[Any]
    grid: Grid | None
    functions: tuple[Function, ...]
    output: bool
    added: list[list[tuple[int, Function]]] = field(default_factory=list)
