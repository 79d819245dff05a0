"""Multiple: independent networks side by side, one for each output."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from golden.common.block import Block
from golden.common.flow import Flow, SideBySide, Wire
from golden.common.port import CLOCKED, Port, group, input_port, output_port
from golden.input_error import InputError
from golden.networks.design import Design
from golden.networks.network import FrameJudge, Network
from golden.numbers.fixed import Codes, Fix
from golden.numbers.precision import SIGNAL


@dataclass(frozen=True)
class OutputCollector(Block):
    """Turns the outputs of several networks into one frame (thesis section 5.5).

    fmt: Format of the results.
    outputs: Number of results of one frame, 1 or more.
    """

    block = "output_collector"
    part_of = "cascade"
    section = "5.5"
    area = "layers"
    latency = 1
    fmt: Fix
    outputs: int

    @property
    def interval(self) -> int:
        return self.outputs

    @property
    def count_width(self) -> int:
        return self.outputs.bit_length()

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            input_port("in_valid", "the results of a frame are there, for this clock"),
            *group(input_port("in_data", "result of network *", self.fmt), self.outputs),
            output_port("out_valid", "`out_data` holds a result"),
            output_port("out_data", "result, in the order of the networks", self.fmt),
            output_port("out_last", "the result is the last of the frame"),
        )


@dataclass(frozen=True)
class Several(Network):
    """Networks of one output each; see the subclasses.

    networks: One per output, in the order of the outputs.
    """

    # Whether each network also takes the outputs of those before it.
    chained: ClassVar[bool] = False
    networks: tuple[Design, ...]

    def __post_init__(self) -> None:
        shapes = [(network.inputs, network.outputs) for network in self.networks]
        expected = [(self.inputs + self.chained * n, 1) for n in range(len(shapes))]
        self.require(
            len(shapes) > 1 and shapes == expected,
            f"networks of (inputs, outputs) {shapes}",
            f"two or more: {expected}",
        )

    @property
    def inputs(self) -> int:
        return self.networks[0].inputs

    @property
    def outputs(self) -> int:
        return len(self.networks)

    def left_out(self) -> list[str]:
        places: dict[str, list[str]] = {}
        for part in self.networks:
            for text in part.left_out():
                places.setdefault(text, []).append(part.entity)
        return [f"{', '.join(names)}: {text}" for text, names in places.items()]

    @property
    def output_collector(self) -> OutputCollector:
        return OutputCollector(SIGNAL, self.outputs)


@dataclass(frozen=True)
class Multiple(Several):
    """y_i = network_i(x): all networks read the same samples (thesis section 3.12, Figure 3.21)."""

    block = "multiple"
    section = "3.12, 6.5"

    def __post_init__(self) -> None:
        super().__post_init__()
        # Each network judges the frames by itself, so with unequal intervals one could refuse a
        # frame that another accepts.
        intervals = [network.interval for network in self.networks]
        if len(set(intervals)) > 1:
            raise InputError(f"{self.entity}: got intervals of {intervals}, expected one interval")

    @property
    def input_controller(self) -> FrameJudge:
        return self.networks[0].input_controller

    @property
    def interval(self) -> int:
        return self.networks[0].interval

    @property
    def latency(self) -> int:
        return max(network.latency for network in self.networks) + self.output_collector.latency

    def flow(self) -> Flow:
        return Flow(
            (
                Wire("samples", SIGNAL),
                SideBySide(self.networks),
                Wire("every y", SIGNAL),
                self.output_collector,
                Wire("outputs", SIGNAL),
            )
        )

    def compute(self, frames: Codes) -> Codes:
        return np.concatenate([network.compute(frames) for network in self.networks], axis=-1)
