"""Output integral: computes one output after the other, on one multiplier per hidden node."""

from dataclasses import dataclass

import numpy as np

from golden.common.port import CLOCKED, Port, Unsigned, group, input_port, output_port
from golden.layers.weighted_sum import RowSums, tree_depth
from golden.numbers.fixed import Codes, signed_width


@dataclass(frozen=True)
class OutputIntegral(RowSums):
    """y_i = (b_i + sum_j w_ij r_j) Y_i, one output per clock (thesis equation 5.2, Figure 5.11).

    in_fmt, coeff_fmt, out_fmt, product_shift: See ``WeightedSum``; the samples are the activations
        r.
    weights: A row for each output.
    factors: De-normalisation Y_i (equation 4.17). With None its multiplier is left out.

    The sum and its product with Y_i are exact. The result is rounded half up (in ``thesis``
    precision there are no bits to drop) and saturated to ``out_fmt``.
    """

    block = "output_integral"
    section = "5.4.5.3"
    factors: tuple[int, ...] | None

    def __post_init__(self) -> None:
        super().__post_init__()
        self.require(
            self.factors is None
            or (len(self.factors) == self.outputs and min(self.factors, default=0) > 0),
            f"factors {self.factors}",
            f"{self.outputs} of 1 or more",
        )

    @property
    def addr_width(self) -> int:
        return max(1, (self.outputs - 1).bit_length())

    @property
    def ports(self) -> tuple[Port, ...]:
        r = input_port("in_r", "r of hidden node *", self.in_fmt)
        return (
            *CLOCKED,
            input_port(
                "in_valid", "`in_addr` holds a row, and the activations belong to its frame"
            ),
            input_port("in_last", "the row is the last of the frame"),
            input_port(
                "in_addr", "row, 0 to outputs - 1", Unsigned(self.addr_width, last=self.outputs - 1)
            ),
            *group(r, self.hidden),
            output_port("out_valid", "`out_data` holds an output"),
            output_port("out_data", "output y", self.out_fmt),
            output_port("out_last", "the output is the last of the frame"),
        )

    @property
    def unreachable(self) -> dict[str, str]:
        return {} if self.outputs > 1 else {"in_last=0": "a frame has one row, its last"}

    @property
    def latency(self) -> int:
        # One clock each for operands and product, one per level of the adder tree, one for the
        # product with the factor, and one for rounding.
        return 2 + tree_depth(self.hidden + 1) + (self.factors is not None) + 1

    @property
    def outputs(self) -> int:
        return len(self.weights)

    @property
    def hidden(self) -> int:
        return len(self.weights[0])

    @property
    def scaled_width(self) -> int:
        """Bits of the sum after the product with its factor."""
        pairs = zip(self.sum_ranges, self.row_factors, strict=True)
        return signed_width(end * factor for ends, factor in pairs for end in ends)

    @property
    def row_factors(self) -> tuple[int, ...]:
        return self.factors or super().row_factors

    def quantities(self, *inputs: Codes) -> dict[str, Codes]:
        addr, _, *activations = inputs
        sums = self.exact(np.stack(activations, axis=-1))
        return {f"sum {row}": sums[addr == row, row] for row in range(self.outputs)}
