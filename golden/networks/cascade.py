"""Cascade: each network sees the samples and the outputs of the networks before it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from golden.block import Block
from golden.fixed import Codes
from golden.networks.hybrid import Hybrid
from golden.networks.network import Network


@dataclass(frozen=True)
class Cascade(Network):
    """y_i = network_i(x, y_1 ... y_(i-1)) (thesis sections 3.12 and 5.5, Figures 3.22 and 5.12).

    Parameters
    ----------
    networks : tuple of Hybrid
        One per output, in the order of the outputs; each has one input more than the one before.

    Raises
    ------
    ValueError
        When a network has more than one output, or inputs that do not follow on.
    """

    block = "cascade"
    networks: tuple[Hybrid, ...]

    def __post_init__(self) -> None:
        shapes = [(network.inputs, network.outputs) for network in self.networks]
        expected = [(self.inputs + i, 1) for i in range(len(shapes))]
        if shapes != expected:
            raise ValueError(
                f"{self.entity}: got networks of (inputs, outputs) {shapes}, expected {expected}"
            )

    @property
    def inputs(self) -> int:
        return self.networks[0].inputs

    @property
    def outputs(self) -> int:
        return len(self.networks)

    @property
    def elements(self) -> int:
        """Elements of the stream that the last network sees: samples, then earlier outputs."""
        return self.networks[-1].inputs

    @property
    def interval(self) -> int:
        return self.elements

    def parts(self) -> tuple[Block, ...]:
        return self.networks

    def compute(self, frames: Codes) -> Codes:
        seen = frames
        for network in self.networks:
            seen = np.concatenate([seen, network.compute(seen)], axis=-1)
        return seen[:, self.inputs :]
