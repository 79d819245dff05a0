"""The networks in Python's integers, which have no width: what no accumulator may differ from."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from golden.block import walk
from golden.fixed import Codes
from golden.layers.weighted_sum import WeightedSum
from golden.networks.arrangement import seen
from golden.networks.hybrid import Hybrid
from golden.networks.network import Network
from golden.networks.parallel import Parallel

# A sum's formats, its weights, its bias, and what it is multiplied by.
Terms = tuple[WeightedSum, Sequence[int], int, int]


def exact_sum(
    formats: WeightedSum, weights: Sequence[int], bias: int, samples: Iterable[int], factor: int = 1
) -> tuple[int, int]:
    """The sum, and the result: rounded half up and saturated."""
    products = (w * x >> formats.product_shift for w, x in zip(weights, samples, strict=True))
    total = (bias << formats.bias_shift) + sum(products)
    shift = formats.out_shift
    result = (total * factor + ((1 << shift) >> 1)) >> shift
    return total, max(formats.out_fmt.low, min(formats.out_fmt.high, result))


def _layers(network: Hybrid | Parallel) -> tuple[list[Terms], list[Terms]]:
    if isinstance(network, Parallel):
        hidden, outputs = (
            [(n, n.weights, n.bias, n.factor or 1) for n in neurons]
            for neurons in (network.hidden_neurons, network.output_neurons)
        )
        return list(hidden), list(outputs)
    last = network.output_integral
    factors = last.factors or (1,) * last.outputs
    return (
        [(n, n.weights, n.bias, 1) for n in network.input_integral.nodes],
        [(last, *row) for row in zip(last.weights, last.biases, factors, strict=True)],
    )


def _column(terms: Terms, frames: Codes) -> Codes:
    """One neuron's result of every frame."""
    formats, weights, bias, factor = terms
    results = (exact_sum(formats, weights, bias, frame, factor)[1] for frame in frames.tolist())
    return np.array(list(results), dtype=np.int64)


def _results(network: Hybrid | Parallel, frames: Codes) -> Codes:
    hidden, outputs = _layers(network)
    r = [
        activation.compute(_column(terms, frames))
        for terms, activation in zip(hidden, network.activations, strict=True)
    ]
    return np.stack([_column(terms, np.stack(r, axis=1)) for terms in outputs], axis=1)


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
    parts = [block for block in walk(design) if isinstance(block, Hybrid | Parallel)]
    found: list[Codes] = []
    for part in parts:
        found.append(_results(part, seen(arrangement, frames, found)))
    return np.concatenate(found, axis=1)
