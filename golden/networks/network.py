"""What all networks have in common: frames go in, and frames come out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.port import CLOCKED, Port, group, input_port, output_port
from golden.engine.frame_check import FrameCheck
from golden.engine.ranges import Range
from golden.input_error import InputError
from golden.layers.argmax import Argmax, ArgmaxTree
from golden.layers.input_controller import InputController
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL

# Number of frames that are computed at a time: 4096 x 16 nodes x 8 bytes fit in a second-level
# cache.
CHUNK = 4096
# A block that decides which frames a network accepts.
FrameJudge = InputController | FrameCheck


@dataclass(frozen=True)
class Network(Block):
    """Computes frames of output codes from frames of sample codes, one frame or millions."""

    area = "networks"
    # How frames enter and leave. "serial": one element per clock. "words": all elements at once.
    # "axi_stream": with a handshake. "converter": codes of an analogue-to-digital converter enter,
    # and a serial frame leaves. "spi": the converter's bits enter.
    stream: ClassVar[str] = "serial"

    @property
    def ports(self) -> tuple[Port, ...]:
        refused = "of the wrong length or that comes too early"
        if self.stream == "serial":
            return serial_ports(
                "a sample", "sample x, in the order of the scene's sensors", refused
            )
        if self.stream == "words":
            return (
                *CLOCKED,
                input_port("in_valid", "`in_data_*` hold the samples of a frame"),
                *group(input_port("in_data", "sample x of sensor *", SIGNAL), self.inputs),
                output_port("out_valid", "`out_data_*` hold the outputs of a frame"),
                *group(output_port("out_data", "output y, number *", SIGNAL), self.outputs),
                frame_error("that comes too early"),
            )
        return super().ports

    @property
    def inputs(self) -> int:
        """The number of samples of one frame."""
        raise NotImplementedError

    @property
    def outputs(self) -> int:
        """The number of results of one frame."""
        raise NotImplementedError

    @property
    def past(self) -> int:
        """How many frames after a reset yield no outputs, because the first outputs need them."""
        return 0

    @property
    def interval(self) -> int:
        """Least clocks from one frame to the next."""
        raise NotImplementedError

    @property
    def input_controller(self) -> FrameJudge:
        """The block that judges frames; its ``inputs`` are the elements of the stream."""
        raise NotImplementedError

    @property
    def busy(self) -> int:
        """Clocks after a frame's last element in which no element of the next frame is accepted."""
        return 0

    @property
    def output_clocks(self) -> tuple[int, ...]:
        """Clocks from a frame's last element to each output; the first is the latency."""
        if self.stream == "words":
            return (self.latency,) * self.outputs
        return tuple(range(self.latency, self.latency + self.outputs))

    @property
    def clocks_after_samples(self) -> int:
        """Clocks from the last sample of a frame to its last output.

        Behind the samples of a cascade of hybrid networks there are slots for the earlier outputs.
        """
        return max(0, self.input_controller.inputs - self.inputs) + self.output_clocks[-1]

    @property
    def frame_clocks(self) -> int:
        """Least clocks from the first element of a frame to its last, both included."""
        return self.input_controller.inputs

    @property
    def image(self) -> bytes:
        """The bytes that must be loaded before it accepts frames; empty where nothing is loaded."""
        return b""

    @property
    def load_ports(self) -> tuple[Port, ...]:
        """The ports through which the image is loaded; none where nothing is loaded."""
        return ()

    @property
    def lesson_ports(self) -> tuple[Port, ...]:
        """The ports through which it learns; none where it does not."""
        return ()

    @property
    def core(self) -> Network:
        """The network without a front end, a readout or another interface around it."""
        return self

    @property
    def argmax(self) -> Argmax | ArgmaxTree | None:
        """What finds the largest output of a frame, where there are ports of it."""
        return None

    @property
    def ranges(self) -> tuple[Range, ...]:
        """The ranges of the hidden layers in which saturation would be an error."""
        return ()

    def parts(self) -> tuple[Block, ...]:
        """Those that the flow names, and what finds the largest output."""
        flow = self.flow()
        return (*(flow.blocks if flow else ()), *([self.argmax] if self.argmax else ()))

    def left_out(self) -> list[str]:
        """Texts about parts that its hardware does not have, because it does not need them."""
        inside = (part for part in self.parts() if isinstance(part, Network))
        return [text for part in inside for text in part.left_out()]

    def compute(self, frames: Codes) -> Codes:
        """Output codes, shape (frames - past, outputs), of a few frames, shape (frames, inputs)."""
        raise NotImplementedError

    def saturations(self, frames: Codes) -> dict[str, Codes]:
        """For each layer whose range is from the data, how many of its sums saturate in each frame.

        frames: shape (frames, inputs).
        """
        return {}

    def process(self, frames: ArrayLike) -> Codes:
        """Compute output codes from frames of sample codes.

        The work is done in chunks that stay in the processor's cache, so the memory beyond the
        results does not grow with the batch.

        frames, shape (..., inputs): Where ``past`` is not 0, the shape is (frames, inputs), in the
            order of time.

        Returns, shape (..., outputs): Where ``past`` is not 0, the first ``past`` frames have no
            row.
        """
        samples, past = np.asarray(frames), self.past
        wrong = samples.ndim == 0 or (past > 0 and samples.ndim != 2)
        if wrong or samples.shape[-1] != self.inputs:
            expected = f"({'frames' if past else '...'}, {self.inputs})"
            raise InputError(
                f"{self.entity} frames: got shape {samples.shape}, expected {expected}"
            )
        flat = samples.reshape(-1, self.inputs)
        results = np.empty((max(0, len(flat) - past), self.outputs), dtype=np.int64)
        for start in range(0, len(results), CHUNK):
            stop = start + CHUNK
            results[start:stop] = self.compute(flat[start : stop + past])
        return results if past else results.reshape(*samples.shape[:-1], self.outputs)


class Around(Network):
    """A network around another one, whose outputs it gives."""

    network: Network

    @property
    def inside(self) -> Network:
        return self.network

    @property
    def inputs(self) -> int:
        return self.inside.inputs

    @property
    def outputs(self) -> int:
        return self.inside.outputs

    @property
    def past(self) -> int:
        return self.inside.past

    @property
    def interval(self) -> int:
        return self.inside.interval

    @property
    def latency(self) -> int:
        return self.output_clocks[0]

    @property
    def input_controller(self) -> FrameJudge:
        return self.inside.input_controller

    @property
    def core(self) -> Network:
        return self.inside.core

    def compute(self, frames: Codes) -> Codes:
        return self.inside.compute(frames)


def serial_ports(element: str, meaning: str, refused: str) -> tuple[Port, ...]:
    """The ports of a network between two streams.

    element, meaning: The elements of a frame, and what ``in_data`` holds.
    refused: The frames that raise ``frame_error``.
    """
    return (
        *CLOCKED,
        input_port("in_valid", f"`in_data` holds {element}"),
        input_port("in_data", meaning, SIGNAL),
        input_port("in_last", "this is the last element of the frame"),
        output_port("out_valid", "`out_data` holds an output"),
        output_port("out_data", "output y, in the order of the scene's outputs", SIGNAL),
        output_port("out_last", "the output is the last of the frame"),
        frame_error(refused),
    )


def frame_error(refused: str) -> Port:
    """The port that reports refused frames; its text says which frames those are."""
    return output_port(
        "frame_error", f"high for one clock for each frame {refused}, which gives no outputs"
    )
