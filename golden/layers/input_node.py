"""One node of the input integral: the weighted sum of a neuron, sample by sample."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.common.border import Border
from golden.common.port import CLOCK, Port, input_port, output_port
from golden.input_error import InputError
from golden.layers.weighted_sum import WeightedSum
from golden.numbers.fixed import Codes, Overflow, Rounding, requantise


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
    section = "5.4.5.1"
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

    def holds(self, weights: ArrayLike, biases: ArrayLike) -> NDArray[np.bool_]:
        """Whether the block may be used with these weights: no samples make a sum overflow.

        See ``partial_sums``.
        """
        least, most = self.partial_sums(weights, biases)
        half = 1 << (self.acc_width - 1)
        return np.asarray((least >= -half) & (most < half))

    @property
    def unreachable(self) -> dict[str, str]:
        why = f"with it a sum can leave its {self.acc_width} bits"
        found = {}
        for end in (self.coeff_fmt.low, self.coeff_fmt.high):
            if not self.holds([end], 0):
                found[f"weight={end}"] = why
            if not self.holds([0], end):
                found[f"bias={end}"] = why
        return found

    @property
    def latency(self) -> int:
        # One clock each for operands, product, accumulator and output.
        return 4

    @property
    def borders(self) -> tuple[Border, ...]:
        half = 1 << (self.acc_width - 1)
        return tuple(
            Border(
                f"sum {name}",
                "sum",
                end,
                1,
                "" if -half < end < half else f"the sum has {self.acc_width} bits",
            )
            for name, end in zip(("saturates below", "saturates above"), self.ends, strict=True)
        )

    def quantities(self, *inputs: Codes) -> dict[str, Codes]:
        return {"sum": self.exact(*inputs)}

    def process(self, frames: ArrayLike, weights: ArrayLike, biases: ArrayLike) -> Codes:
        """Results in ``out_fmt``, shape (...), for frames of samples, shape (..., inputs).

        See ``exact``.
        """
        exact = self.exact(frames, weights, biases)
        return requantise(exact, self.out_shift, self.out_fmt, Rounding.ROUND, Overflow.SATURATE)

    def exact(self, frames: ArrayLike, weights: ArrayLike, biases: ArrayLike) -> Codes:
        """The sums before they are rounded.

        frames, shape (..., inputs): Codes of ``in_fmt``.
        weights, shape (..., inputs): Codes of ``coeff_fmt``; the weight of each sample.
        biases, shape (...): Codes of ``coeff_fmt``; the bias of each frame.
        """
        x = self.in_fmt.check(frames, f"{self.block} frames")
        w = self.coeff_fmt.check(weights, f"{self.block} weights")
        b = self.coeff_fmt.check(biases, f"{self.block} biases")
        start = b << self.bias_shift
        sums = start[..., np.newaxis] + np.cumsum((w * x) >> self.product_shift, axis=-1)
        half = 1 << (self.acc_width - 1)
        if sums.min() < -half or sums.max() >= half:
            raise InputError(
                f"{self.entity}: got sums from {sums.min()} to {sums.max()}, expected "
                f"{self.acc_width} bits"
            )
        return np.asarray(sums[..., -1], dtype=np.int64)
