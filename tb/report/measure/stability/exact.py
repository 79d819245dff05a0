"""The networks in Python's integers, which have no width: what no accumulator may differ from."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from golden.block import walk
from golden.fixed import Codes
from golden.layers.weighted_sum import WeightedSum
from golden.networks.arrangement import seen
from golden.networks.design import Design, ExactSum
from golden.networks.network import Network


def exact_sum(
    formats: WeightedSum, weights: Sequence[int], bias: int, samples: Iterable[int], factor: int = 1
) -> tuple[int, int]:
    """The sum, and the result: rounded half up and saturated."""
    products = (w * x >> formats.product_shift for w, x in zip(weights, samples, strict=True))
    total = (bias << formats.bias_shift) + sum(products)
    shift = formats.out_shift
    result = (total * factor + ((1 << shift) >> 1)) >> shift
    return total, max(formats.out_fmt.low, min(formats.out_fmt.high, result))


def _column(one: ExactSum, frames: Codes) -> Codes:
    """One neuron's result of every frame."""
    results = (
        exact_sum(one.formats, one.weights, one.bias, frame, one.factor)[1]
        for frame in frames.tolist()
    )
    return np.array(list(results), dtype=np.int64)


def _results(network: Design, frames: Codes) -> Codes:
    layers = network.exact_layers
    r = [
        activation.compute(_column(one, frames))
        for one, activation in zip(layers.hidden, layers.activations, strict=True)
    ]
    return np.stack([_column(one, np.stack(r, axis=1)) for one in layers.outputs], axis=1)


def exact_network(design: Network, arrangement: str, frames: Codes) -> Codes:
    """Output codes, shape (frames, outputs), of frames of sample codes, shape (frames, inputs).

    The activations are the twin's own, part by part instead of from its table of results.

    Parameters
    ----------
    design : Network
    arrangement : str
        How the networks of ``design`` stand to each other.
    frames : int64 array
    """
    parts = [block for block in walk(design) if isinstance(block, Design)]
    found: list[Codes] = []
    for part in parts:
        found.append(_results(part, seen(arrangement, frames, found)))
    return np.concatenate(found, axis=1)
