"""multiply_accumulate: adds up products, one in each clock."""

from dataclasses import dataclass

from golden.common.port import CLOCK, Port, Unsigned, input_port, output_port
from golden.engine.accumulator import Accumulator
from golden.engine.formats import PRODUCT_WIDTH, WIDTH, WORD
from golden.numbers.fixed import Fix


@dataclass(frozen=True)
class MultiplyAccumulate(Accumulator):
    """acc = operand x coefficient + (acc, or half a unit of the result).

    The coefficient is the bitwise OR of the program's weight and of a word of the table, one of
    which is 0. Products and sums are exact. A sum starts with half a unit of its result, so that
    dropping bits rounds the result half up.
    """

    block = "multiply_accumulate"
    part_of = "learning_engine"
    latency = 4

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            CLOCK,
            input_port("operand", "multiplicand", WORD),
            input_port(
                "weight",
                "weight of the program, or 0 if the table gives the coefficient",
                Unsigned(WIDTH),
            ),
            input_port("take_intercept", "take the intercept of the table, not its slope"),
            input_port("table_word", "intercept and slope, or 0", Unsigned(PRODUCT_WIDTH)),
            input_port("first", "two clocks after an operand: its product starts a sum"),
            input_port("first_of_output", "its product starts the sum of an output"),
            output_port("acc", "the sum, four clocks after the operand", Fix(self.acc_width, 0)),
        )
