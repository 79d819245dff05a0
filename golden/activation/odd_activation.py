"""What all activations have in common that compute on the magnitude of a code alone."""

from dataclasses import dataclass

from golden.activation.abs_unit import AbsUnit
from golden.activation.activation_block import ActivationBlock
from golden.activation.sign_retriever import SignRetriever


@dataclass(frozen=True)
class OddActivation(ActivationBlock):
    """Splits off the sign of a code, and gives it back to the result."""

    @property
    def abs_unit(self) -> AbsUnit:
        return AbsUnit(self.in_fmt)

    @property
    def sign_retriever(self) -> SignRetriever:
        return SignRetriever(self.out_fmt)
