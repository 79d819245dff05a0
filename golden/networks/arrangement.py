"""How the networks of a scene are arranged: single, multiple or cascade."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from golden.input_error import InputError
from golden.networks.cascade import Cascade
from golden.networks.design import DEFAULTS, Design, Settings
from golden.networks.multiple import Multiple
from golden.networks.network import Network
from golden.numbers.real import Real
from golden.trained.dense import Activation, DenseNetwork

ARRANGEMENTS = ("single", "multiple", "cascade")

Number = TypeVar("Number", np.int64, np.float64)


def seen(
    arrangement: str, samples: NDArray[Number], earlier: Sequence[NDArray[Number]]
) -> NDArray[Number]:
    """The inputs of a network: the samples and, in a cascade, the outputs of earlier networks.

    samples: shape (frames, sensors).
    earlier, shape (frames, 1): Outputs of the networks before this one.
    """
    return np.concatenate([samples, *earlier], axis=-1) if arrangement == "cascade" else samples


def process_real(
    arrangement: str, networks: Sequence[DenseNetwork], samples: Real, activation: Activation
) -> Real:
    """Outputs of all networks in floating point, shape (frames, outputs)."""
    results: list[Real] = []
    for network in networks:
        results.append(network.process(seen(arrangement, samples, results), activation))
    return np.concatenate(results, axis=-1)


def arrange(
    arrangement: str,
    trained: Sequence[DenseNetwork],
    design: type[Design],
    settings: Settings = DEFAULTS,
) -> Network:
    """The bit-true twin of all networks together; of one alone, that network's.

    design: What each of them becomes, or all of them where the design takes them ``together``.
    """
    if len(trained) == 1 or arrangement in design.together:
        return design.of(trained, settings, arrangement)
    if arrangement not in design.arrangements:
        raise InputError(f"{arrangement}: got networks {design.block}, expected a design for it")
    networks = [design.of([one], settings, variant=str(i)) for i, one in enumerate(trained)]
    if arrangement == "cascade":
        return Cascade(tuple(networks))
    # Each takes the frames that the slowest takes. One result a clock leaves; a cascade's frames
    # are longer than that in any case.
    slowest = max(len(networks), *(network.interval for network in networks))
    return Multiple(tuple(replace(n, min_interval=slowest) for n in networks))
