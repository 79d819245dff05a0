"""One node of the input integral: a neuron's weighted sum of serial samples."""

from __future__ import annotations

from dataclasses import dataclass

from golden.layers.node_sum import NodeSum


@dataclass(frozen=True)
class InputNode(NodeSum):
    """q = b + sum_k w_k x_k on one multiplier (thesis equation 5.1, Figure 5.9).

    Parameters
    ----------
    in_fmt, coeff_fmt, out_fmt, product_shift, weights, bias
        See ``NodeSum``; the samples arrive in the order of the weights, and the accumulator starts
        from the bias.
    """

    block = "input_node"

    @property
    def latency(self) -> int:
        # Operands, product, accumulator, output.
        return 4
