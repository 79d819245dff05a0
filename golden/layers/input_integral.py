"""Input integral: all nodes of the hidden layer side by side."""

from dataclasses import dataclass

from golden.common.block import Block
from golden.common.port import CLOCK, Port, Unsigned, group, input_port, output_port
from golden.layers.weighted_sum import RowSums, WeightedSum
from golden.numbers.fixed import Codes


@dataclass(frozen=True)
class InputNode(WeightedSum):
    """q = b + sum_k w_k x_k on one multiplier (thesis equation 5.1, Figure 5.9).

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
        return input_port("in_data", "a sample", self.in_fmt)

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
            input_port("weight", "weight of the sample, in the same clock", self.coeff_fmt),
            input_port("bias", "bias, in the clock of `preset`", self.coeff_fmt),
            *self.controls,
            output_port(
                "out_data",
                "q, or q / Q where sums are normalised; held until the next `capture`",
                self.out_fmt,
            ),
        )


@dataclass(frozen=True)
class InputIntegral(RowSums):
    """q_j = b_j + sum_k w_jk x_k for every hidden node j (thesis section 5.4.5.1).

    weights: A row for each hidden node.

    The block holds the weights and biases. All its nodes are instances of one entity, whose
    accumulator holds the widest sum of all.
    """

    block = "input_integral"
    section = "5.4.5.1"

    @property
    def inputs(self) -> int:
        return len(self.weights[0])

    @property
    def hidden(self) -> int:
        return len(self.weights)

    @property
    def addr_width(self) -> int:
        return max(1, (self.inputs - 1).bit_length())

    @property
    def node(self) -> InputNode:
        return InputNode(
            self.in_fmt, self.coeff_fmt, self.out_fmt, self.product_shift, self.acc_width
        )

    @property
    def ports(self) -> tuple[Port, ...]:
        node = self.node
        q = output_port(
            "out_q",
            "hidden node *: q, or q / Q where sums are normalised; held until the next `capture`",
            self.out_fmt,
        )
        return (
            CLOCK,
            node.sample,
            input_port(
                "addr",
                "position of the sample in its frame, in the same clock",
                Unsigned(self.addr_width, last=self.inputs - 1),
            ),
            *node.controls,
            *group(q, self.hidden),
        )

    @property
    def latency(self) -> int:
        return self.node.latency

    def parts(self) -> tuple[Block, ...]:
        return (self.node,) * self.hidden

    def quantities(self, *inputs: Codes) -> dict[str, Codes]:
        (frames,) = inputs
        return {f"sum {j}": sums for j, sums in enumerate(self.exact(frames).T)}
