"""Input integral: all nodes of the hidden layer side by side."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.block import Block
from golden.fixed import Codes, Overflow, Rounding, requantise
from golden.layers.input_node import InputNode
from golden.port import Port, given, group


@dataclass(frozen=True)
class InputIntegral(Block):
    """q_j = b_j + sum_k w_jk x_k for every hidden node j (thesis section 5.4.5.1).

    Parameters
    ----------
    nodes : tuple of InputNode
        One per hidden node; all take the same samples in the same formats.
    """

    block = "input_integral"
    section = "5.4.5.1"
    area = "layers"
    nodes: tuple[InputNode, ...]

    def __post_init__(self) -> None:
        shapes = {
            (len(n.weights), n.in_fmt, n.coeff_fmt, n.out_fmt, n.product_shift) for n in self.nodes
        }
        if len(shapes) != 1:
            raise ValueError(f"{self.entity}: got nodes of shapes {shapes}, expected one shape")

    @property
    def inputs(self) -> int:
        """Samples of one frame."""
        return len(self.nodes[0].weights)

    @property
    def ports(self) -> tuple[Port, ...]:
        node = self.nodes[0]
        q = given(
            "out_q",
            "hidden node *: q, or q / Q where sums are normalised; held until the next `capture`",
            node.out_fmt,
            "out_fmt",
        )
        return (*node.controls, *group(q, len(self.nodes)))

    @property
    def latency(self) -> int:
        return self.nodes[0].latency

    def parts(self) -> tuple[Block, ...]:
        return self.nodes

    def process(self, frames: ArrayLike) -> Codes:
        """Results, shape (..., hidden), of frames of samples, shape (..., inputs).

        Raises
        ------
        ValueError
            For a wrong last axis or a code outside the nodes' ``in_fmt``.
        """
        node = self.nodes[0]
        x = node.in_fmt.check(frames, f"{self.entity} frames", self.inputs)
        weights = np.array([n.weights for n in self.nodes])
        acc = node.sums(x, weights, np.array([n.bias for n in self.nodes]))
        return requantise(acc, node.out_shift, node.out_fmt, Rounding.ROUND, Overflow.SATURATE)
