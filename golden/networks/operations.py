"""Multiplications and additions that one frame costs, from the equations of a network.

Activation functions are left out, as in thesis section 3.11.3. An addition has two operands; a
subtraction is one; a sum of n numbers is n - 1. Constants are computed beforehand.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Operations:
    """Counts for one frame."""

    multiplications: int
    additions: int


def mlp_operations(shape: tuple[int, int, int]) -> Operations:
    """Equation 3.11: every node sums its products and its bias.

    Parameters
    ----------
    shape : tuple of int
        Inputs, hidden nodes and outputs.
    """
    inputs, hidden, outputs = shape
    weights = hidden * inputs + outputs * hidden
    return Operations(weights, weights)


def rbf_operations(shape: tuple[int, int, int]) -> Operations:
    """Equations 3.13 and 3.14 as they stand.

    A node takes one difference and one square an input, their sum, and one multiplication by
    -1 / (2 sigma^2); an output is as in the MLP.
    """
    inputs, hidden, outputs = shape
    return Operations(
        hidden * (inputs + 1) + outputs * hidden,
        hidden * (2 * inputs - 1) + outputs * hidden,
    )


def rbf_operations_drawn(shape: tuple[int, int, int]) -> Operations:
    """The same network as section 3.11.3 counts its block diagram, Figure 3.16.

    The squared distance is drawn as sum(X*X) - sum(X*C) + sum(C*C). A node has sum(X*C) and
    sum(C*C), with one multiplication beyond the inputs in each; sum(X*X) is shared. Two more
    additions a node join the three, one multiplication a node divides by the width. At an output,
    the sum of all products counts as one addition, whatever the number of its operands, and the
    bias as another.
    """
    inputs, hidden, outputs = shape
    return Operations(
        hidden * 2 * (inputs + 1) + inputs + hidden + outputs * hidden,
        hidden * 2 * (inputs - 1) + (inputs - 1) + 2 * hidden + 2 * outputs,
    )
