"""What every network has in common: frames in, frames out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from golden.block import Block
from golden.fixed import Codes
from golden.layers.input_controller import InputController
from golden.sensing.scan_sequencer import ScanSequencer

# Frames computed at a time; 4096 x 16 nodes x 8 bytes fit a second-level cache.
CHUNK = 4096


@dataclass(frozen=True)
class Network(Block):
    """From frames of sample codes to frames of output codes, one frame at a time or millions."""

    area = "networks"
    # How frames come and go: "serial", an element a clock; "words", all at once; "axi_stream",
    # with a handshake; "converter", codes of an analogue-to-digital converter in, a serial frame
    # out.
    stream: ClassVar[str] = "serial"

    @property
    def inputs(self) -> int:
        """Samples of one frame."""
        raise NotImplementedError

    @property
    def outputs(self) -> int:
        """Results of one frame."""
        raise NotImplementedError

    @property
    def interval(self) -> int:
        """Least clocks from one frame to the next."""
        raise NotImplementedError

    @property
    def input_controller(self) -> InputController:
        """The controller that judges frames; its ``inputs`` are the elements of the stream."""
        raise NotImplementedError

    @property
    def frame_clocks(self) -> int:
        """Least clocks from the first element of a frame to its last, both included."""
        return self.input_controller.inputs

    @property
    def members(self) -> tuple[Network, ...]:
        """The networks that this one is arranged of, in the order of the outputs."""
        return ()

    @property
    def core(self) -> Network:
        """The network without front end, readout or another interface around it."""
        return self

    @property
    def scanner(self) -> ScanSequencer | None:
        """What makes the frames, where ``stream`` is ``converter``."""
        return None

    def compute(self, frames: Codes) -> Codes:
        """Output codes, shape (frames, outputs), of a few frames, shape (frames, inputs)."""
        raise NotImplementedError

    def left_out(self) -> list[str]:
        """What this network does not need and therefore does not build."""
        raise NotImplementedError

    def process(self, frames: ArrayLike) -> Codes:
        """Output codes, shape (..., outputs), of frames of sample codes, shape (..., inputs).

        Computed in chunks that stay in the processor's cache, so that memory beyond the results
        does not grow with the batch.

        Raises
        ------
        ValueError
            For a wrong last axis or a code outside the signal format.
        """
        samples = np.asarray(frames)
        if samples.ndim == 0 or samples.shape[-1] != self.inputs:
            raise ValueError(
                f"{self.entity} frames: got shape {samples.shape}, expected (..., {self.inputs})"
            )
        flat = samples.reshape(-1, self.inputs)
        results = np.empty((len(flat), self.outputs), dtype=np.int64)
        for start in range(0, len(flat), CHUNK):
            part = slice(start, start + CHUNK)
            results[part] = self.compute(flat[part])
        return results.reshape(*samples.shape[:-1], self.outputs)
