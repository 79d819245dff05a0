"""One node of the input integral: the weighted sum of a neuron, sample by sample."""

from dataclasses import dataclass

from golden.common.port import CLOCK, Port, input_port, output_port
from golden.layers.weighted_sum import WeightedSum


@dataclass(frozen=True)
class InputNode(WeightedSum):
    """q = b + sum_k w_k x_k on one multiplier (thesis equation 5.1, Figure 5.9).

    in_fmt, coeff_fmt, out_fmt, product_shift: See ``WeightedSum``.
    acc_width: Bits of the accumulator. The block that supplies the weights ensures that every
        partial sum fits.

    Weights and bias enter through ports. So nodes that differ only in them are one entity, whose
    name contains the fraction bits of the weights and the bits of the sum.
    """

    block = "input_node"
    part_of = "input_integral"
    section = "5.4.5.1"
    # One clock each for operands, product, accumulator and output.
    latency = 4
    acc_width: int

    @property
    def entity(self) -> str:
        return f"{super().entity}_fraction{self.coeff_fmt.frac}_sum{self.acc_width}"

    @property
    def sample(self) -> Port:
        """The sample that all nodes of a layer share."""
        return input_port("in_data", "a sample", self.in_fmt, "in_fmt")

    @property
    def controls(self) -> tuple[Port, ...]:
        """The signals with which CONTROLLER 1 controls all nodes of a layer."""
        return (
            input_port(
                "preset",
                "two clocks after the first sample of a frame: add its product to the bias",
            ),
            input_port(
                "accumulate", "two clocks after each sample: take the sum into the accumulator"
            ),
            input_port(
                "capture",
                "one clock after the last `accumulate` of a frame: hand the sum to the output",
            ),
        )

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            CLOCK,
            self.sample,
            input_port(
                "weight", "weight of the sample, in the same clock", self.coeff_fmt, "coeff_fmt"
            ),
            input_port("bias", "bias, in the clock of `preset`", self.coeff_fmt, "coeff_fmt"),
            *self.controls,
            output_port(
                "out_data",
                "q, or q / Q where sums are normalised; held until the next `capture`",
                self.out_fmt,
                "out_fmt",
            ),
        )
