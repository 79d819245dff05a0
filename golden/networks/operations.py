"""Multiplications and additions for one frame, counted from the equations of a network.

Activation functions are not counted, as in thesis section 3.11.3. An addition has two operands and
a subtraction counts as one, so a sum of n numbers is n - 1 additions. Constants are computed
beforehand.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Operations:
    """The numbers of operations for one frame."""

    multiplications: int
    additions: int


def mlp_operations(shape: tuple[int, int, int]) -> Operations:
    """Equation 3.11: every node adds up its products and its bias.

    shape: Inputs, hidden nodes and outputs.
    """
    inputs, hidden, outputs = shape
    weights = hidden * inputs + outputs * hidden
    return Operations(weights, weights)


def rbf_operations(shape: tuple[int, int, int]) -> Operations:
    """Equations 3.13 and 3.14, counted as they are written.

    For each input a node has one difference and one square; it adds the squares up and multiplies
    by -1 / (2 sigma^2) once. An output is like one of the MLP.
    """
    inputs, hidden, outputs = shape
    return Operations(
        hidden * (inputs + 1) + outputs * hidden,
        hidden * (2 * inputs - 1) + outputs * hidden,
    )


def rbf_operations_drawn(shape: tuple[int, int, int]) -> Operations:
    """The same network, counted as section 3.11.3 does with the block diagram, Figure 3.16.

    The squared distance is drawn as sum(X*X) - sum(X*C) + sum(C*C). Each node has sum(X*C) and
    sum(C*C), each with one multiplication more than there are inputs; sum(X*X) is shared by all
    nodes. Per node two more additions join the three sums, and one multiplication divides by the
    width. At an output, the sum of all products counts as one addition, whatever the number of its
    operands, and the bias as another.
    """
    inputs, hidden, outputs = shape
    return Operations(
        hidden * 2 * (inputs + 1) + inputs + hidden + outputs * hidden,
        hidden * 2 * (inputs - 1) + (inputs - 1) + 2 * hidden + 2 * outputs,
    )
