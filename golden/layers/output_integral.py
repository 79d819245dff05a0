"""Output integral: computes one output after the other, on one multiplier per hidden node."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.border import Border
from golden.common.port import CLOCKED, Port, Unsigned, group, input_port, output_port
from golden.input_error import InputError
from golden.layers.weighted_sum import WeightedSum, tree_depth
from golden.numbers.fixed import Codes, Overflow, Rounding, requantise, signed_width


@dataclass(frozen=True)
class OutputIntegral(WeightedSum):
    """y_i = (b_i + sum_j w_ij r_j) Y_i, one output per clock (thesis equation 5.2, Figure 5.11).

    in_fmt, coeff_fmt, out_fmt, product_shift: See ``WeightedSum``; the samples are the activations
        r.
    weights: One row of codes of ``coeff_fmt`` per output.
    biases: Codes of ``coeff_fmt``, one per output.
    factors: De-normalisation Y_i (equation 4.17). With None its multiplier is left out.

    The sum and its product with Y_i are exact. The result is rounded half up (in ``thesis``
    precision there are no bits to drop) and saturated to ``out_fmt``.
    """

    block = "output_integral"
    section = "5.4.5.3"
    weights: tuple[tuple[int, ...], ...]
    biases: tuple[int, ...]
    factors: tuple[int, ...] | None

    def __post_init__(self) -> None:
        super().__post_init__()
        self.coeff_fmt.check(np.array(self.weights), f"{self.entity} weights", self.hidden)
        self.coeff_fmt.check(np.array(self.biases), f"{self.entity} biases", self.outputs)
        if self.factors is not None and (
            len(self.factors) != self.outputs or min(self.factors) < 1
        ):
            raise InputError(
                f"{self.entity}: got factors {self.factors}, expected {self.outputs} of 1 or more"
            )

    @property
    def addr_width(self) -> int:
        return max(1, (self.outputs - 1).bit_length())

    @property
    def ports(self) -> tuple[Port, ...]:
        r = input_port("in_r", "r of hidden node *", self.in_fmt, "in_fmt")
        return (
            *CLOCKED,
            input_port(
                "in_valid", "`in_addr` holds a row, and the activations belong to its frame"
            ),
            input_port("in_last", "the row is the last of the frame"),
            input_port(
                "in_addr",
                "row, 0 to outputs - 1",
                Unsigned(self.addr_width, last=self.outputs - 1),
                "addr_width",
            ),
            *group(r, self.hidden),
            output_port("out_valid", "`out_data` holds an output"),
            output_port("out_data", "output y", self.out_fmt, "out_fmt"),
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

    def sum_range(self, row: int) -> tuple[int, int]:
        """Least and largest value of any partial sum of output ``row``."""
        least, most = self.partial_sums(self.weights[row], self.biases[row])
        return int(least), int(most)

    @property
    def acc_width(self) -> int:
        """Bits of the sum. They are enough for every partial sum of every output."""
        return signed_width(end for i in range(self.outputs) for end in self.sum_range(i))

    @property
    def scaled_width(self) -> int:
        """Bits of the sum after the product with its factor."""
        if self.factors is None:
            return self.acc_width
        return signed_width(
            end * self.factors[i] for i in range(self.outputs) for end in self.sum_range(i)
        )

    @property
    def borders(self) -> tuple[Border, ...]:
        factors = self.factors or (1,) * self.outputs
        rows = enumerate(zip(self.weights, self.biases, factors, strict=True))
        return tuple(
            border
            for i, (row, bias, factor) in rows
            for border in self.borders_of(f"sum {i}", np.array(row), bias, factor)
        )

    def quantities(self, *inputs: Codes) -> dict[str, Codes]:
        addr, _, *activations = inputs
        sums = self.exact(np.stack(activations, axis=-1))
        return {f"sum {row}": sums[addr == row, row] for row in range(self.outputs)}

    def process(self, activations: ArrayLike) -> Codes:
        """Results in ``out_fmt``, shape (..., outputs), for activations, shape (..., hidden)."""
        acc = self.exact(activations)
        if self.factors is not None:
            acc = acc * np.asarray(self.factors, dtype=np.int64)
        return requantise(acc, self.out_shift, self.out_fmt, Rounding.ROUND, Overflow.SATURATE)

    def exact(self, activations: ArrayLike) -> Codes:
        """The sums before the product with their factors; see ``process``."""
        r = self.in_fmt.check(activations, "output_integral activations", self.hidden)
        return self.sums(r, np.array(self.weights), np.array(self.biases))
