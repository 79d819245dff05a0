"""What a bench is given of its scene: the twin of the whole design, networks, recorded frames.

The runner reads the scene and writes this; the bench in the simulator reads it. So the bench does
not read the scene again, for which it would import the twins of all designs and activations. That
would take longer than many a bench.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from golden.networks.network import Network
from golden.numbers.fixed import Codes
from golden.trained.dense import DenseNetwork
from golden.trained.window import Window


@dataclass(frozen=True)
class BenchInput:
    """The twin, the networks and the recorded frames of a scene.

    design: The twin of the scene's whole design.
    recordings, shape (frames, sensors): The codes of the frames of each recording, as they are sent
        to the hardware.
    met: What the layers of each network meet in the data, as the scene's settings have it.
    shipped: The same of the shipped scenes that the bench names in ``SCENES``.
    """

    name: str
    design: Network
    recordings: tuple[Codes, ...]
    window: Window
    networks: tuple[DenseNetwork, ...]
    arrangement: str
    met: Sequence[Sequence[float]]
    shipped: tuple["BenchInput", ...] = ()

    @cached_property
    def codes(self) -> Codes:
        """The inputs of the networks for each recorded frame that has a complete past."""
        return np.concatenate([self.window.frames(codes) for codes in self.recordings])
