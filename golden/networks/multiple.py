"""Multiple: independent networks side by side, one for each output."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from golden.block import Block
from golden.fixed import Codes
from golden.networks.hybrid import Hybrid
from golden.networks.network import Network


@dataclass(frozen=True)
class Multiple(Network):
    """y_i = network_i(x): every network sees the same samples (thesis section 3.12, Figure 3.21).

    Parameters
    ----------
    networks : tuple of Hybrid
        One per output, in the order of the outputs.

    Raises
    ------
    ValueError
        When a network has more than one output, or another number of inputs than the first.
    """

    block = "multiple"
    networks: tuple[Hybrid, ...]

    def __post_init__(self) -> None:
        shapes = [(network.inputs, network.outputs) for network in self.networks]
        if shapes != [(self.inputs, 1)] * len(shapes):
            raise ValueError(
                f"{self.entity}: got networks of (inputs, outputs) {shapes}, expected one output "
                f"each from the same {self.inputs} inputs"
            )

    @property
    def inputs(self) -> int:
        return self.networks[0].inputs

    @property
    def outputs(self) -> int:
        return len(self.networks)

    @property
    def interval(self) -> int:
        return max(self.inputs, self.outputs)

    def parts(self) -> tuple[Block, ...]:
        return self.networks

    def compute(self, frames: Codes) -> Codes:
        return np.concatenate([network.compute(frames) for network in self.networks], axis=-1)
