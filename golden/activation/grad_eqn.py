"""GRAD_EQN: multiplies the gradient by the magnitude and adds the intercept."""

from dataclasses import dataclass

from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.port import CLOCKED, Port, Unsigned, input_port, output_port
from golden.numbers.fixed import Codes, Fix, Rounding, check_unsigned, cut


@dataclass(frozen=True)
class GradEqn(Block):
    """f = G_n m + i_n with one multiplier (thesis equation 4.23, section 5.4.5.2).

    mag_width, mag_frac: Format of the unsigned magnitude m.
    coeff_width, coeff_frac: Format of the unsigned gradient G_n.
    intercept_width, intercept_frac: Format of the unsigned intercept i_n; it has at most as many
        fraction bits as the product.
    out_fmt: Format of the result, which is never negative.
    rounding: TRUNCATE or ROUND, applied to the exact sum.

    ``golden.activation.segments`` refuses a segment whose largest result does not fit in
    ``out_fmt``, so the block has no saturation logic. A magnitude beyond the neuron's reach wraps.
    """

    block = "grad_eqn"
    section = "5.4.5.2"
    area = "activation"
    # One clock each for operands, product and sum.
    latency = 3
    mag_width: int
    mag_frac: int
    coeff_width: int
    coeff_frac: int
    intercept_width: int
    intercept_frac: int
    out_fmt: Fix
    rounding: Rounding

    def __post_init__(self) -> None:
        for name, frac in (("intercept", self.intercept_frac), ("result", self.out_fmt.frac)):
            self.require(
                frac <= self.product_frac,
                f"{frac} fraction bits of the {name}",
                f"{self.product_frac} at most, those of the product",
            )

    @property
    def product_frac(self) -> int:
        return self.mag_frac + self.coeff_frac

    @property
    def intercept_shift(self) -> int:
        return self.product_frac - self.intercept_frac

    @property
    def out_shift(self) -> int:
        return self.product_frac - self.out_fmt.frac

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            input_port("in_valid", "the three operands belong together and are valid"),
            input_port("in_mag", "magnitude of q", Unsigned(self.mag_width, self.mag_frac)),
            input_port("in_coeff", "gradient G_n", Unsigned(self.coeff_width, self.coeff_frac)),
            input_port(
                "in_intercept", "intercept i_n", Unsigned(self.intercept_width, self.intercept_frac)
            ),
            output_port("out_valid", "`out_data` holds a result"),
            output_port(
                "out_data",
                "magnitude of the activation",
                Unsigned(self.out_fmt.width - 1, self.out_fmt.frac),
            ),
        )

    def process(self, mag: ArrayLike, coeff: ArrayLike, intercept: ArrayLike) -> Codes:
        """Result codes, 0 to ``out_fmt.high``; the arguments broadcast."""
        m = check_unsigned(mag, self.mag_width, "grad_eqn mag")
        g = check_unsigned(coeff, self.coeff_width, "grad_eqn coeff")
        i = check_unsigned(intercept, self.intercept_width, "grad_eqn intercept")
        total = m * g + (i << self.intercept_shift)
        return cut(total, self.out_shift, self.rounding) & self.out_fmt.high
