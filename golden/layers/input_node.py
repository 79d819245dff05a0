"""One node of the input integral: a neuron's weighted sum of serial samples."""

from __future__ import annotations

from dataclasses import dataclass

from golden.layers.node_sum import NodeSum
from golden.port import CLOCK, Port, Unsigned, given, taken


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
    section = "5.4.5.1"

    @property
    def addr_width(self) -> int:
        """Bits of a sample's position in its frame."""
        return max(1, (len(self.weights) - 1).bit_length())

    @property
    def controls(self) -> tuple[Port, ...]:
        """Its inputs, which all nodes of a layer share."""
        return (
            CLOCK,
            taken("in_data", "a sample", self.in_fmt, "in_fmt"),
            taken(
                "addr",
                "position of the sample in its frame, in the same clock",
                Unsigned(self.addr_width),
                "addr_width",
            ),
            taken(
                "preset",
                "two clocks after the first sample of a frame: add its product to the bias",
            ),
            taken("accumulate", "two clocks after each sample: take the sum into the accumulator"),
            taken(
                "capture",
                "one clock after the last `accumulate` of a frame: hand the sum to the output",
            ),
        )

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *self.controls,
            given(
                "out_data",
                "q, or q / Q where sums are normalised; held until the next `capture`",
                self.out_fmt,
                "out_fmt",
            ),
        )

    @property
    def latency(self) -> int:
        # Operands, product, accumulator, output.
        return 4
