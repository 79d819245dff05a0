"""Multiple: independent networks side by side, one for each output."""

from dataclasses import dataclass

import numpy as np

from golden.common.block import Block
from golden.input_error import InputError
from golden.layers.frame_judge import FrameJudge
from golden.networks.several import Several
from golden.numbers.fixed import Codes


@dataclass(frozen=True)
class Multiple(Several):
    """y_i = network_i(x): all networks read the same samples (thesis section 3.12, Figure 3.21).

    networks: One per output, in the order of the outputs; all have the same number of inputs.
    """

    block = "multiple"
    section = "3.12, 6.5"

    def __post_init__(self) -> None:
        super().__post_init__()
        # Each network judges the frames by itself, so with unequal intervals one could refuse a
        # frame that another accepts.
        intervals = [network.interval for network in self.networks]
        if len(set(intervals)) > 1:
            raise InputError(f"{self.entity}: got intervals of {intervals}, expected one interval")

    def _inputs_of(self, number: int) -> int:
        return self.inputs

    @property
    def input_controller(self) -> FrameJudge:
        return self.networks[0].input_controller

    @property
    def interval(self) -> int:
        return self.networks[0].interval

    @property
    def latency(self) -> int:
        return max(network.latency for network in self.networks) + self.output_collector.latency

    def parts(self) -> tuple[Block, ...]:
        return (*self.networks, self.output_collector)

    def compute(self, frames: Codes) -> Codes:
        return np.concatenate([network.compute(frames) for network in self.networks], axis=-1)
