"""Cascade: each network sees the samples and the outputs of the networks before it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from golden.block import Block
from golden.fixed import Codes
from golden.flow import Carried, Flow, Step
from golden.layers.input_controller import InputController
from golden.networks.several import Several
from golden.precision import SIGNAL
from golden.sensing.stream_multiplexer import StreamMultiplexer


@dataclass(frozen=True)
class Cascade(Several):
    """y_i = network_i(x, y_1 ... y_(i-1)) (thesis sections 3.12 and 5.5, Figures 3.22 and 5.12).

    Parameters
    ----------
    networks : tuple of Design
        One per output, in the order of the outputs; each has one input more than the one before.

    Raises
    ------
    ValueError
        See ``Several``; also for a network that needs more clocks between frames than a frame has
        elements.

    Notes
    -----
    A frame of the hardware's stream has as many elements as the last network has inputs: the
    samples, then slots into which the earlier outputs are put.
    """

    block = "cascade"

    def __post_init__(self) -> None:
        super().__post_init__()
        # A network sees the beginning of a frame, also of one that ends too early or too late, and
        # takes it for a whole one: were it to refuse the next as too close, the others would not.
        for network in self.networks:
            if network.interval > network.inputs:
                raise ValueError(
                    f"{network.entity}: needs {network.interval} clocks from frame to frame, "
                    f"expected at most {network.inputs}, the elements that it sees of a frame"
                )

    def _inputs_of(self, number: int) -> int:
        return self.inputs + number

    @property
    def input_controller(self) -> InputController:
        return InputController(self.networks[-1].inputs, 0, variant="frame")

    @property
    def interval(self) -> int:
        return self.input_controller.inputs

    @property
    def multiplexers(self) -> tuple[StreamMultiplexer, ...]:
        """One between each network and the next."""
        return tuple(
            StreamMultiplexer(SIGNAL, slot, variant=str(slot))
            for slot in range(self.inputs, self.networks[-1].inputs)
        )

    def parts(self) -> tuple[Block, ...]:
        return (
            self.input_controller,
            *self.networks,
            *self.multiplexers,
            self.output_collector,
        )

    def flow(self) -> Flow:
        steps: list[Step] = [Carried(f"frames of {self.input_controller.inputs} elements", SIGNAL)]
        for network, multiplexer in zip(self.networks, self.multiplexers, strict=False):
            steps += [network, None, multiplexer, Carried(f"y in slot {multiplexer.slot}", SIGNAL)]
        steps += [self.networks[-1], Carried("every y", SIGNAL)]
        steps += [self.output_collector, Carried("outputs", SIGNAL)]
        return Flow(tuple(steps), watcher=self.input_controller)

    def compute(self, frames: Codes) -> Codes:
        seen = frames
        for network in self.networks:
            seen = np.concatenate([seen, network.compute(seen)], axis=-1)
        return seen[:, self.inputs :]
