"""How the networks of a scene stand to each other: single, multiple or cascade."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from golden.dense import Trained
from golden.input_error import InputError
from golden.mlp import Activation
from golden.networks.cascade import Cascade
from golden.networks.design import Design
from golden.networks.multiple import Multiple
from golden.networks.network import Network
from golden.real import Real

ARRANGEMENTS = ("single", "multiple", "cascade")

Number = TypeVar("Number", np.int64, np.float64)


def seen(
    arrangement: str, samples: NDArray[Number], earlier: Sequence[NDArray[Number]]
) -> NDArray[Number]:
    """What a network sees: the samples and, in a cascade, the outputs of the networks before it.

    Parameters
    ----------
    arrangement : str
    samples : array, shape (frames, sensors)
    earlier : sequence of arrays, shape (frames, 1)
        Outputs of the networks before it.
    """
    return np.concatenate([samples, *earlier], axis=-1) if arrangement == "cascade" else samples


def process_real(
    arrangement: str, networks: Sequence[Trained], samples: Real, activation: Activation
) -> Real:
    """Outputs of all networks in floating point, shape (frames, outputs)."""
    results: list[Real] = []
    for network in networks:
        results.append(network.process(seen(arrangement, samples, results), activation))
    return np.concatenate(results, axis=-1)


def arrange(
    arrangement: str, trained: Sequence[Trained], build: Callable[[Trained, str], Design]
) -> Network:
    """The bit-true twin of all networks together; of one alone, that network's.

    Parameters
    ----------
    arrangement : str
    trained : sequence of Mlp or DenseNetwork
    build : callable
        The bit-true network of one, from its weights and the variant that tells it from others.
    """
    if len(trained) == 1:
        return build(trained[0], "")
    networks = tuple(build(one, str(i)) for i, one in enumerate(trained))
    if arrangement not in networks[0].arrangements:
        raise InputError(
            f"{arrangement}: got networks {networks[0].block}, expected a design for it"
        )
    if arrangement == "cascade":
        return Cascade(networks)
    # One result a clock leaves (a cascade's frames are longer than that in any case), and all take
    # the frames that the slowest takes.
    slowest = max(len(networks), *(network.interval for network in networks))
    return Multiple(tuple(replace(n, min_interval=slowest) for n in networks))
