"""Neuron: a weighted sum of samples that arrive all at once."""

from dataclasses import dataclass

from golden.common.port import CLOCK, Port, group, input_port, output_port
from golden.input_error import InputError
from golden.layers.node_sum import NodeSum
from golden.layers.weighted_sum import tree_depth
from golden.numbers.fixed import Codes


@dataclass(frozen=True)
class Neuron(NodeSum):
    """(b + sum_k w_k x_k) Y, with a multiplier for every weight (thesis section 5.2.1).

    in_fmt, coeff_fmt, out_fmt, product_shift, weights, bias: See ``NodeSum``.
    factor: De-normalisation Y_i of an output (equation 4.17). With None its multiplier is left out.

    The sum and its product with the factor are exact. The result is rounded half up and saturated
    to ``out_fmt``.
    """

    block = "neuron"
    part_of = "parallel"
    section = "5.2.1"
    factor: int | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.factor is not None and self.factor < 1:
            raise InputError(f"{self.entity}: got factor={self.factor}, expected 1 or more")

    @property
    def ports(self) -> tuple[Port, ...]:
        samples = input_port("in_data", "sample *", self.in_fmt, "in_fmt")
        return (
            CLOCK,
            *group(samples, len(self.weights)),
            output_port(
                "out_data",
                "q of a hidden neuron, or q / Q where sums are normalised; y of an output",
                self.out_fmt,
                "out_fmt",
            ),
        )

    @property
    def latency(self) -> int:
        # One clock for the product, one per level of the adder tree, one for the product with the
        # factor, and one for rounding.
        return 1 + tree_depth(len(self.weights) + 1) + (self.factor is not None) + 1

    @property
    def scaled_width(self) -> int:
        """Bits of the sum after the product with its factor."""
        return self.acc_width + ((self.factor or 1) - 1).bit_length()

    def scaled(self, acc: Codes) -> Codes:
        return acc if self.factor is None else acc * self.factor
