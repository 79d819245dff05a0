"""How the networks of a scene are arranged: single, multiple or cascade."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from golden.input_error import InputError
from golden.mlp import Activation, Mlp
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
    """The inputs of a network: the samples and, in a cascade, the outputs of earlier networks.

    Parameters
    ----------
    arrangement : str
    samples : array, shape (frames, sensors)
    earlier : sequence of arrays, shape (frames, 1)
        Outputs of the networks before this one.
    """
    return np.concatenate([samples, *earlier], axis=-1) if arrangement == "cascade" else samples


def process_real(
    arrangement: str, mlps: Sequence[Mlp], samples: Real, activation: Activation
) -> Real:
    """Outputs of all networks in floating point, shape (frames, outputs)."""
    results: list[Real] = []
    for mlp in mlps:
        results.append(mlp.process(seen(arrangement, samples, results), activation))
    return np.concatenate(results, axis=-1)


def arrange(arrangement: str, mlps: Sequence[Mlp], build: Callable[[Mlp, str], Design]) -> Network:
    """The bit-true twin of all networks together; a single network is its own twin.

    Parameters
    ----------
    arrangement : str
    mlps : sequence of Mlp
    build : callable
        Builds the bit-true network from an Mlp and from the variant that distinguishes it.
    """
    if len(mlps) == 1:
        return build(mlps[0], "")
    networks = tuple(build(mlp, str(i)) for i, mlp in enumerate(mlps))
    if arrangement not in networks[0].arrangements:
        raise InputError(
            f"{arrangement}: got networks {networks[0].block}, expected a design for it"
        )
    if arrangement == "cascade":
        return Cascade(networks)
    # One result leaves per clock, and all networks must accept the same frames, so the interval is
    # that of the slowest. The frames of a cascade are longer than its outputs in any case.
    slowest = max(len(networks), *(network.interval for network in networks))
    return Multiple(tuple(replace(n, min_interval=slowest) for n in networks))
