"""Frame window: stores past frames, and sends the samples of them that a network reads."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.port import CLOCKED, Port, input_port, output_port
from golden.layers.input_controller import InputController
from golden.numbers.fixed import Codes, Fix
from golden.trained.window import Window


@dataclass(frozen=True)
class FrameWindow(Block):
    """Stores good frames in a ring. After each, it sends samples of this frame and of past ones.

    fmt: Format of the samples.
    window: The samples that leave.
    slots: Number of further elements, of any content, that a network's frame has after its samples.
    spacing: Least clocks that the network needs from the last sample of one good frame to the last
        sample of the next. It is 0, and its counter is left out, where a frame has enough samples.

    A frame is judged like by ``InputController``: a frame that has the wrong length or ends too
    early raises one error and is not stored. After a reset nothing leaves before ``past`` good
    frames have come. Until then the contents of the ring are not used, so the ring needs no reset.

    The number of words of the ring is a power of two, so that addresses wrap by themselves. There
    is at least one more than the frames take, so that no word is read in the clock in which it is
    written.
    """

    block = "frame_window"
    area = "sensing"
    # One clock each for the ring's address, for its word, and until the frame counts as the
    # newest.
    latency = 3
    fmt: Fix
    window: Window
    slots: int
    spacing: int

    def __post_init__(self) -> None:
        self.require(
            self.slots >= 0 and self.interval >= self.elements,
            f"slots={self.slots} and spacing={self.spacing}",
            f"0 or more slots, and {self.elements} clocks or more from frame to frame, in which "
            "the elements are sent",
        )

    @property
    def sensors(self) -> int:
        return len(self.window.delays)

    @property
    def elements(self) -> int:
        return len(self.window.taps) + self.slots

    @property
    def past(self) -> int:
        return self.window.past

    @property
    def addr_width(self) -> int:
        return (self.sensors * (self.past + 2)).bit_length()

    @property
    def words(self) -> int:
        return 1 << self.addr_width

    @property
    def offsets(self) -> tuple[int, ...]:
        """For each sample that leaves: how many words it is before the end of the newest frame."""
        return tuple(self.sensors * (tap.delay + 1) - tap.sensor for tap in self.window.taps)

    @property
    def input_controller(self) -> InputController:
        """Judges frames as this block does. It is not built."""
        return InputController(self.sensors, self.spacing)

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            input_port("in_valid", "`in_data` holds a sample"),
            input_port("in_data", "sample x, in the order of the scene's sensors", self.fmt),
            input_port("in_last", "the sample is the last of the frame"),
            output_port("out_valid", "`out_data` holds an element"),
            output_port(
                "out_data",
                "a sample of the newest frame or of a past one, in the order of `window.taps`; "
                "then `slots` elements of any content",
                self.fmt,
            ),
            output_port("out_last", "the element is the last of the frame"),
            output_port(
                "frame_error",
                "high for one clock for each frame of the wrong length or that comes too early, "
                "which does not enter the past",
            ),
        )

    @property
    def interval(self) -> int:
        return max(self.sensors, self.spacing)

    def facts(self) -> tuple[str, ...]:
        return (f"{self.past} past frames", f"{self.words} words")

    def process(self, frames: ArrayLike) -> Codes:
        """The samples that leave, shape (frames - past, taps), for good frames after a reset.

        frames, shape (frames, sensors): Good frames in the order of time.
        """
        codes = self.fmt.check(frames, f"{self.entity} frames", self.sensors)
        return self.window.frames(codes).astype(np.int64)
