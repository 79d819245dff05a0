"""The codes behind the quantisers of a network, layer by layer, as an engine computes them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from golden.dense import Trained, layers_of
from golden.engine.formats import DROPPED, PRODUCT_WIDTH, SAMPLE_SHIFT
from golden.engine.layers import first_values, planned
from golden.engine.round_saturate import RoundSaturate
from golden.fixed import Codes
from golden.real import Real


def engine_codes(network: Trained, frames: Codes) -> Iterator[Codes]:
    """The codes of each hidden layer, shape (frames, nodes), as differences from the lowest code.

    It ends at the first layer without a quantiser.

    Parameters
    ----------
    network : Mlp or DenseNetwork
        On signals. It reads samples alone.
    frames : int64 array, shape (frames, inputs)
    """
    words = np.asarray(frames) << SAMPLE_SHIFT
    for layer in planned(network, first_values(words.shape[1], 0)):
        if layer.grid is None:
            return
        starts = (np.array(layer.biases) << DROPPED) + layer.rests + (1 << (DROPPED - 1))
        stored = RoundSaturate(
            acc_width=PRODUCT_WIDTH, rectifies=True, cut=layer.grid.cut, even=layer.grid.even
        )
        words = stored.process(1, words @ np.array(layer.weights).T + starts, 0, relu=1)
        yield words >> layer.grid.cut


def file_codes(network: Trained, readings: Real) -> Iterator[Codes]:
    """The same by evaluating the network node by node in double precision.

    Parameters
    ----------
    network : Mlp or DenseNetwork
        As its file holds it.
    readings : float array, shape (frames, inputs)
    """
    values = np.asarray(readings, dtype=np.float64)
    for layer in layers_of(network):
        values, _ = layer.activate(values @ layer.weights.T + layer.biases)
        quantiser = layer.quantiser
        if quantiser is None:
            return
        values = quantiser.process(values)
        lowest = max(quantiser.low, quantiser.zero) if layer.activation == "relu" else quantiser.low
        yield np.rint(values / quantiser.scale).astype(np.int64) + quantiser.zero - lowest
