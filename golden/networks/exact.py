"""A network of two layers in Python's integers, which never overflow.

Every design must give the same results.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from golden.activation.activation_block import ActivationBlock
from golden.layers.weighted_sum import WeightedSum
from golden.numbers.fixed import Codes


@dataclass(frozen=True)
class ExactSum:
    """One neuron's sum, computed in integers of unlimited width.

    factor: Factor by which the sum is multiplied.
    """

    formats: WeightedSum
    weights: Sequence[int]
    bias: int
    factor: int = 1

    def process(self, frames: Codes) -> Codes:
        """The neuron's result for every frame."""
        results = (
            exact_sum(self.formats, self.weights, self.bias, frame, self.factor)[1]
            for frame in frames.tolist()
        )
        return np.array(list(results), dtype=np.int64)


@dataclass(frozen=True)
class ExactLayers:
    """A network of two layers as sums and activations.

    activations: One per hidden node.
    """

    hidden: list[ExactSum]
    activations: tuple[ActivationBlock, ...]
    outputs: list[ExactSum]

    def process(self, frames: Codes) -> Codes:
        """Output codes; activations are computed by parts, not read from tables of results."""
        pairs = zip(self.hidden, self.activations, strict=True)
        r = np.stack([activation.compute(one.process(frames)) for one, activation in pairs], axis=1)
        return np.stack([one.process(r) for one in self.outputs], axis=1)


def exact_sum(
    formats: WeightedSum, weights: Sequence[int], bias: int, samples: Iterable[int], factor: int = 1
) -> tuple[int, int]:
    """The sum of a neuron, and its result, which is rounded half up and saturated."""
    products = (w * x >> formats.product_shift for w, x in zip(weights, samples, strict=True))
    total = (bias << formats.bias_shift) + sum(products)
    shift = formats.out_shift
    result = (total * factor + ((1 << shift) >> 1)) >> shift
    return total, max(formats.out_fmt.low, min(formats.out_fmt.high, result))
