"""What all activations have in common that compute on the magnitude of a code alone."""

from dataclasses import dataclass

import numpy as np

from golden.activation.abs_unit import AbsUnit
from golden.activation.activation_block import ActivationBlock
from golden.activation.comparator_bank import ComparatorBank
from golden.activation.sign_retriever import SignRetriever
from golden.common.block import Block
from golden.numbers.fixed import Codes


@dataclass(frozen=True)
class OddActivation(ActivationBlock):
    """Splits off the sign of a code, and gives it back to the result."""

    @property
    def abs_unit(self) -> AbsUnit:
        return AbsUnit(self.in_fmt)

    @property
    def sign_retriever(self) -> SignRetriever:
        return SignRetriever(self.out_fmt)


class Compared(OddActivation):
    """Compares the magnitude with thresholds; beyond the last of them the result is the largest.

    A subclass has ``thresholds`` among its fields: the last magnitude code of each segment that the
    neuron can exceed.
    """

    thresholds: tuple[int, ...]

    @property
    def comparator_bank(self) -> ComparatorBank:
        return ComparatorBank(self.abs_unit.mag_width, self.thresholds, variant=self.variant)

    def parts(self) -> tuple[Block, ...]:
        return self.abs_unit, self.comparator_bank, self.sign_retriever

    @property
    def marks(self) -> tuple[int, ...]:
        return self.thresholds

    def compute(self, data: Codes) -> Codes:
        negative = self.abs_unit.process(data)[1]
        result = np.clip(self.unlimited(data)["result"], *self.limits["result"])
        magnitude = np.where(self.curved(data), result, self.out_fmt.high)
        return self.sign_retriever.process(magnitude, negative)
