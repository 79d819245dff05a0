"""Computes the networks of a scene in integers of unlimited width."""

from __future__ import annotations

import numpy as np

from golden.block import walk
from golden.fixed import Codes
from golden.networks.arrangement import seen
from golden.networks.design import Design
from golden.networks.network import Network
from golden.networks.oracle import exact


def exact_network(design: Network, arrangement: str, frames: Codes) -> Codes:
    """The output codes, shape (frames, outputs), for sample codes, shape (frames, inputs).

    Parameters
    ----------
    design : Network
    arrangement : str
        The arrangement of the networks in ``design``.
    frames : int64 array
    """
    parts = [block for block in walk(design) if isinstance(block, Design)]
    found: list[Codes] = []
    for part in parts:
        found.append(exact(part, seen(arrangement, frames, found)))
    return np.concatenate(found, axis=1)
