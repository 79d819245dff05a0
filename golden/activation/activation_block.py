"""What all activations have in common, so that a network can use any of them."""

from collections import Counter
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.activation.abs_unit import AbsUnit
from golden.activation.comparator_bank import ComparatorBank
from golden.activation.sign_retriever import SignRetriever
from golden.common.block import Block
from golden.common.border import Border, border_among
from golden.common.port import CLOCKED, Port, input_port, output_port
from golden.numbers.fixed import Codes, Fix

# Kinds of parts that an activation may lack.
COMPARATORS = "comparators of segments no neuron reaches"
MULTIPLIERS = "multipliers of segments no neuron reaches"
ROM_WORDS = "ROM words of segments no neuron reaches"
TABLE_WORDS = "table words that no neuron reaches"


@dataclass(frozen=True)
class ActivationBlock(Block):
    """Computes r from q, or from q divided by Q, with one result every ``interval`` clocks.

    A subclass computes in ``compute``. Its hardware keeps a result on ``out_data`` at least until
    the input changes, because a folded network reads it more than once.

    in_fmt, out_fmt: Formats of input and result.

    half_codes: Whether a code c stands for the middle of its step, c + 1/2, both at the input and
        at the result.
    """

    half_codes: ClassVar[bool] = False
    area = "activation"
    in_fmt: Fix
    out_fmt: Fix

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            input_port("in_valid", "`in_data` holds a code"),
            input_port("in_data", "q, or q / Q where sums are normalised", self.in_fmt),
            output_port("out_valid", "`out_data` holds a result"),
            output_port("out_data", "r, which stays at least as long as the input", self.out_fmt),
        )

    def process(self, data: ArrayLike) -> Codes:
        """Activation codes in ``out_fmt``, with the shape of ``data``.

        They are looked up in a table of ``compute`` for every input code, because a neuron of a
        network that runs for long meets each code many times.
        """
        codes = self.in_fmt.check(data, f"{self.block} data")
        return np.take(_results(self), codes).astype(np.int64)

    def real_input(self, codes: ArrayLike) -> NDArray[np.float64]:
        """The q, or q / Q, for which codes of the input stand."""
        return self._real(codes, self.in_fmt)

    def real_result(self, codes: ArrayLike) -> NDArray[np.float64]:
        """The r for which codes of the result stand."""
        return self._real(codes, self.out_fmt)

    def _real(self, codes: ArrayLike, fmt: Fix) -> NDArray[np.float64]:
        return fmt.to_real(np.asarray(codes) + 0.5 * self.half_codes)

    def compute(self, data: Codes) -> Codes:
        """The activation codes, computed part by part as the hardware does it."""
        raise NotImplementedError

    def parts_left_out(self) -> Counter[str]:
        """How many parts of each kind the block lacks because the neuron cannot need them."""
        return Counter()

    @property
    def marks(self) -> tuple[int, ...]:
        """The largest magnitude of each segment but the last."""
        return ()

    @property
    def limits(self) -> dict[str, tuple[int, int]]:
        """The internal numbers that saturate, each with its least and largest value."""
        return {}

    def unlimited(self, data: Codes) -> dict[str, Codes]:
        """These numbers before they saturate, for codes whose result depends on them."""
        return {}

    def curved(self, data: Codes) -> NDArray[np.bool_]:
        """Whether the result of each code depends on ``unlimited``."""
        return np.ones(np.shape(data), dtype=bool)

    @property
    def borders(self) -> tuple[Border, ...]:
        return _borders(self)

    def quantities(self, *inputs: Codes) -> dict[str, Codes]:
        (data,) = inputs
        return {"magnitude": np.abs(data)} | self.unlimited(data[self.curved(data)])

    @property
    def border_codes(self) -> Codes:
        return _border_codes(self)


def _codes(fmt: Fix) -> Codes:
    return np.arange(fmt.low, fmt.high + 1)


@lru_cache(maxsize=256)
def _borders(activation: ActivationBlock) -> tuple[Border, ...]:
    """The borders of the segments and of saturation, over every code of the input."""
    found = [Border(f"magnitude above {mark}", "magnitude", mark + 1) for mark in activation.marks]
    numbers = activation.quantities(_codes(activation.in_fmt))
    for name, (low, high) in activation.limits.items():
        found.append(border_among(f"{name} saturates below", name, low, numbers[name]))
        found.append(border_among(f"{name} saturates above", name, high + 1, numbers[name]))
    return tuple(found)


@lru_cache(maxsize=256)
def _border_codes(activation: ActivationBlock) -> Codes:
    every = _codes(activation.in_fmt)
    inside = every[activation.curved(every)]
    numbers = activation.unlimited(inside)
    found = [np.array(activation.marks, dtype=np.int64)]
    for border in activation.borders:
        if border.quantity in numbers and not border.unreachable:
            values = numbers[border.quantity]
            places = border.closest(values)
            found.append(inside[places[np.abs(values[places] - border.at) <= border.within]])
    return np.concatenate(found)


@lru_cache(maxsize=256)
def _results(activation: ActivationBlock) -> Codes:
    """The activation of every input code, first from 0 up and then the negative codes.

    A negative code is thus a negative index of numpy. The smallest possible integer type keeps the
    tables of a network in the processor's cache.
    """
    fmt = activation.in_fmt
    codes = np.concatenate([np.arange(fmt.high + 1), np.arange(fmt.low, 0)])
    return activation.compute(codes).astype(np.min_scalar_type(activation.out_fmt.low))


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
