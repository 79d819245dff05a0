"""Computes the networks of a scene in integers of unlimited width."""

import numpy as np

from golden.networks.arrangement import seen
from golden.networks.network import Network
from golden.networks.oracle import designs_in, exact
from golden.numbers.fixed import Codes


def exact_network(design: Network, arrangement: str, frames: Codes) -> Codes:
    """The output codes, shape (frames, outputs), for sample codes, shape (frames, inputs).

    arrangement: The arrangement of the networks in ``design``.
    """
    found: list[Codes] = []
    for part in designs_in(design):
        found.append(exact(part, seen(arrangement, frames, found)))
    return np.concatenate(found, axis=1)
