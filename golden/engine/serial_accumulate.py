"""serial_accumulate: doubles a sum for each bit plane, and adds coefficients to it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.port import CLOCK, Port, Unsigned, input_port, output_port
from golden.engine.accumulator import Accumulator
from golden.engine.fields import signed_code
from golden.engine.formats import WIDTH
from golden.engine.replay import CLEAR, HALF_OUTPUT_PLANE, HALF_PLANE
from golden.numbers.fixed import Codes, Fix


@dataclass(frozen=True)
class SerialAccumulate(Accumulator):
    """acc = coefficient added to or subtracted from acc, or from 2 acc at a pass's start; or 0.

    At the start of a pass the sum is doubled. In the plane of half a unit of the result, this half
    unit is added too, so that the result is rounded half up. The coefficient is the bitwise OR of
    the program's weight, where that counts, and of a word of the table, which is 0 elsewhere.
    """

    block = "serial_accumulate"

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            CLOCK,
            input_port("weight", "weight of the program", Unsigned(WIDTH)),
            input_port("take_weight", "`weight` counts"),
            input_port("subtract", "the coefficient is subtracted"),
            input_port(
                "plane", "one bit of 19 is set; the highest clears the sum", Unsigned(CLEAR + 1)
            ),
            input_port("first", "the word is the first of its pass"),
            input_port("of_output", "the sum is that of an output"),
            input_port(
                "table_word", "word of the table, or 0; one clock after `weight`", Unsigned(WIDTH)
            ),
            output_port("acc", "the sum, three clocks later", Fix(self.acc_width, 0)),
        )

    @property
    def latency(self) -> int:
        return 3

    def process(
        self,
        weight: ArrayLike,
        take_weight: ArrayLike,
        subtract: ArrayLike,
        plane: ArrayLike,
        first: ArrayLike,
        of_output: ArrayLike,
        table_word: ArrayLike,
    ) -> Codes:
        """The sum after each word, starting from 0; ``table_word`` belongs to the same word.

        A sum that does not fit in its bits wraps; the sums of an assembled program always fit.
        """
        gated = np.where(take_weight, weight, 0)
        bits = np.asarray(gated, dtype=np.int64) | np.asarray(table_word, dtype=np.int64)
        coeff = signed_code(bits)
        change = np.where(subtract, -coeff, coeff)
        planes = np.asarray(plane, dtype=np.int64)
        half_planes = np.where(of_output, 1 << HALF_OUTPUT_PLANE, 1 << HALF_PLANE)
        half = (planes & half_planes != 0).astype(np.int64)
        acc, found = 0, []
        for value, shift, extra, clears in zip(
            change.tolist(),
            np.asarray(first).tolist(),
            half.tolist(),
            (planes >> CLEAR).tolist(),
            strict=True,
        ):
            acc = 0 if clears else (2 * acc + extra if shift else acc) + value
            acc = self.wrapped(acc)
            found.append(acc)
        return np.array(found, dtype=np.int64)
