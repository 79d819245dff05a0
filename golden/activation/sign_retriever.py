"""Sign retriever: gives a magnitude its sign back."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.port import CLOCKED, Port, Unsigned, input_port, output_port
from golden.input_error import InputError
from golden.numbers.fixed import Codes, Fix


@dataclass(frozen=True)
class SignRetriever(Block):
    """Negates a magnitude when its flag is set (thesis section 4.5.2.4).

    fmt: Format of the output; the magnitude is unsigned with one bit less.

    The result is exact: every magnitude has both signs in ``fmt``. The most negative code never
    comes out.
    """

    block = "sign_retriever"
    section = "4.5.2.4"
    area = "activation"
    latency = 1
    fmt: Fix

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            input_port("in_valid", "`in_mag` and `in_negative` are valid"),
            input_port("in_mag", "magnitude", Unsigned(self.fmt.width - 1, self.fmt.frac)),
            input_port("in_negative", "the result is to be negative"),
            output_port("out_valid", "`out_data` holds a result"),
            output_port("out_data", "the magnitude with its sign", self.fmt),
        )

    def process(self, mag: ArrayLike, negative: ArrayLike) -> Codes:
        """The magnitudes with their signs, as codes of ``fmt``."""
        codes = self.fmt.check(mag, "sign_retriever mag")
        if (codes < 0).any():
            raise InputError(f"sign_retriever mag: got {int(codes.min())}, expected 0 or more")
        return np.where(np.asarray(negative, dtype=bool), -codes, codes)
