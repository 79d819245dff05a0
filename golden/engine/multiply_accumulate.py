"""multiply_accumulate: adds up products, one in each clock."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.port import CLOCK, Port, Unsigned, input_port, output_port
from golden.engine.accumulator import Accumulator
from golden.engine.fields import signed_code
from golden.engine.formats import DROPPED, OUTPUT_SHIFT, PRODUCT_WIDTH, WIDTH
from golden.engine.operand_memory import WORD
from golden.numbers.fixed import Codes, Fix


@dataclass(frozen=True)
class MultiplyAccumulate(Accumulator):
    """acc = operand x coefficient + (acc, or half a unit of the result).

    The coefficient is the bitwise OR of the program's weight and of a word of the table, one of
    which is 0. Products and sums are exact. A sum starts with half a unit of its result, so that
    dropping bits rounds the result half up.
    """

    block = "multiply_accumulate"

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

    @property
    def latency(self) -> int:
        return 4

    def process(
        self,
        operand: ArrayLike,
        weight: ArrayLike,
        take_intercept: ArrayLike,
        table_word: ArrayLike,
        first: ArrayLike,
        first_of_output: ArrayLike,
    ) -> Codes:
        """The sum after each product. The first product starts a sum.

        ``first`` and ``first_of_output`` belong to the product of the same index. A sum that does
        not fit in its bits wraps; the sums of an assembled program always fit.
        """
        table = np.asarray(table_word, dtype=np.int64)
        mask = (1 << WIDTH) - 1
        chosen = np.where(take_intercept, table >> WIDTH, table & mask)
        bits = np.asarray(weight, dtype=np.int64) | chosen
        product = np.asarray(operand, dtype=np.int64) * signed_code(bits)
        half = 1 << (DROPPED - 1)
        acc, found = 0, []
        for value, opens, output in zip(
            product.tolist(),
            np.asarray(first).tolist(),
            np.asarray(first_of_output).tolist(),
            strict=True,
        ):
            start = half << OUTPUT_SHIFT if output else half if opens else acc
            acc = self.wrapped(value + start)
            found.append(acc)
        return np.array(found, dtype=np.int64)
