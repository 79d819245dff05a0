"""Cascade: each network sees the samples and the outputs of the networks before it."""

from dataclasses import dataclass

import numpy as np

from golden.common.block import Block
from golden.common.flow import Flow, Step, Wire, WithController
from golden.common.port import Port
from golden.layers.input_controller import InputController
from golden.networks.multiple import OutputCollector, Several
from golden.networks.network import serial_ports
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL
from golden.sensing.stream_multiplexer import StreamMultiplexer


@dataclass(frozen=True)
class Cascade(Several):
    """y_i = network_i(x, y_1 ... y_(i-1)) (thesis sections 3.12 and 5.5, Figures 3.22 and 5.12).

    A frame of the hardware's stream has as many elements as the last network has inputs: the
    samples, and then slots for the earlier outputs.

    A network sees the beginning of every frame, also of one that ends too early or too late, and
    takes it for a whole frame. Where a network needs more clocks than it sees elements, it could
    then refuse the next frame as too close while the others accept it. Therefore a cascade with
    such a network has a ``frame_store``: the controller judges whole frames, and the networks see
    only good ones, at least ``interval`` clocks apart.
    """

    block = "cascade"
    section = "5.5"
    chained = True

    @property
    def input_controller(self) -> InputController:
        return InputController.every(self.interval, self.networks[-1].inputs)

    @property
    def interval(self) -> int:
        return max(self.networks[-1].inputs, *(network.interval for network in self.networks))

    @property
    def frame_store(self) -> OutputCollector | None:
        """Passes on the elements of a frame that was found good; None where no network needs it."""
        if all(network.interval <= network.inputs for network in self.networks):
            return None
        return OutputCollector(SIGNAL, self.networks[-1].inputs, variant="frame")

    def left_out(self) -> list[str]:
        stored = f"{self.entity}: the memory that holds a frame until it is judged"
        return super().left_out() + [stored] * (not self.frame_store)

    @property
    def multiplexers(self) -> tuple[StreamMultiplexer, ...]:
        """The multiplexers, one between each network and the next."""
        return tuple(
            StreamMultiplexer(SIGNAL, slot, variant=str(slot))
            for slot in range(self.inputs, self.networks[-1].inputs)
        )

    @property
    def ports(self) -> tuple[Port, ...]:
        early = " or that comes too early" if self.input_controller.spacing else ""
        return serial_ports(
            "an element",
            "samples x, in the order of the scene's sensors, then one element, whatever it holds, "
            "for each output but the last",
            f"of the wrong length{early}",
        )

    @property
    def latency(self) -> int:
        """It includes that of a frame store, whose last element leaves after all others."""
        parts = [*self.networks, *self.multiplexers, self.output_collector]
        clocks = sum(part.latency for part in parts)
        if self.frame_store is None:
            return clocks
        first = self.input_controller.latency + self.frame_store.latency
        return clocks + first + self.frame_store.outputs - 1

    def parts(self) -> tuple[Block, ...]:
        return (
            self.input_controller,
            *([self.frame_store] if self.frame_store else []),
            *self.networks,
            *self.multiplexers,
            self.output_collector,
        )

    def flow(self) -> Flow:
        steps: list[Step] = [Wire(f"frames of {self.input_controller.inputs} elements", SIGNAL)]
        if self.frame_store:
            steps += [WithController(self.input_controller, self.frame_store)]
            steps += [Wire("good frames", SIGNAL)]
        for member, multiplexer in zip(self.networks, self.multiplexers, strict=False):
            steps += [member, None, multiplexer, Wire(f"y in slot {multiplexer.slot}", SIGNAL)]
        steps += [self.networks[-1], Wire("every y", SIGNAL)]
        steps += [self.output_collector, Wire("outputs", SIGNAL)]
        return Flow(tuple(steps), watcher=None if self.frame_store else self.input_controller)

    def compute(self, frames: Codes) -> Codes:
        seen = frames
        for network in self.networks:
            seen = np.concatenate([seen, network.compute(seen)], axis=-1)
        return seen[:, self.inputs :]
