"""Frame window: past frames kept, and the samples of them that a network takes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from golden.block import Block
from golden.fixed import Codes, Fix
from golden.input_error import InputError
from golden.layers.input_controller import InputController
from golden.port import CLOCKED, Port, given, taken
from golden.window import Window


@dataclass(frozen=True)
class FrameWindow(Block):
    """Good frames go into a ring; after each a frame of its samples and of past ones leaves.

    Parameters
    ----------
    fmt : Fix
        Format of the samples.
    window : Window
        Which samples leave.
    slots : int
        Elements behind them, whatever they hold: those that a network's frame has beside samples.
    spacing : int
        Least clocks from the last sample of one good frame to the last sample of the next, which
        the network needs; 0, and its counter is left out, where a frame has samples enough.

    Raises
    ------
    InputError
        For a negative number, or frames that may follow faster than they are sent.

    Notes
    -----
    A frame is judged as by ``InputController``: one of the wrong length, or that ends too early,
    raises one error and does not enter the past. After a reset nothing leaves before ``past`` good
    frames have come; what the ring holds then does not matter, so it needs no reset.

    The ring is counted in words, of which there are a power of two, so that addresses wrap by
    themselves. It holds the frames of the past, the newest, and the one that comes meanwhile; with
    one word more, none is ever read in the clock in which it is written.
    """

    block = "frame_window"
    area = "sensing"
    fmt: Fix
    window: Window
    slots: int
    spacing: int

    def __post_init__(self) -> None:
        if self.slots < 0 or self.interval < self.elements:
            raise InputError(
                f"{self.entity}: got slots={self.slots} and spacing={self.spacing}, expected 0 or "
                f"more slots, and {self.elements} clocks or more from frame to frame, in which the "
                "elements are sent"
            )

    @property
    def sensors(self) -> int:
        """Samples of a frame."""
        return len(self.window.delays)

    @property
    def elements(self) -> int:
        """Elements of a frame that leaves."""
        return len(self.window.taps) + self.slots

    @property
    def past(self) -> int:
        """Frames after a reset from which nothing leaves."""
        return self.window.past

    @property
    def addr_width(self) -> int:
        """Bits of the ring's address."""
        return (self.sensors * (self.past + 2)).bit_length()

    @property
    def words(self) -> int:
        """Words of the ring."""
        return 1 << self.addr_width

    @property
    def offsets(self) -> tuple[int, ...]:
        """Of each sample that leaves: words before the end of the newest frame."""
        return tuple(self.sensors * (tap.delay + 1) - tap.sensor for tap in self.window.taps)

    @property
    def input_controller(self) -> InputController:
        """Judges frames as this block does; it is no part."""
        return InputController(self.sensors, self.spacing)

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            taken("in_valid", "`in_data` holds a sample"),
            taken("in_data", "sample x, in the order of the scene's sensors", self.fmt, "fmt"),
            taken("in_last", "the sample is the last of the frame"),
            given("out_valid", "`out_data` holds an element"),
            given(
                "out_data",
                "a sample of the newest frame or of a past one, in the order of `window.taps`; "
                "then `slots` elements of any content",
                self.fmt,
                "fmt",
            ),
            given("out_last", "the element is the last of the frame"),
            given(
                "frame_error",
                "high for one clock for each frame of the wrong length or that comes too early, "
                "which does not enter the past",
            ),
        )

    @property
    def latency(self) -> int:
        # The ring's address, its word, and the clock in which the frame has become the newest.
        return 3

    @property
    def interval(self) -> int:
        return max(self.sensors, self.spacing)

    def facts(self) -> tuple[str, ...]:
        return (f"{self.past} past frames", f"{self.words} words")

    def process(self, frames: ArrayLike) -> Codes:
        """The samples that leave, shape (frames - past, taps), for good frames after a reset.

        Parameters
        ----------
        frames : array_like of int, shape (frames, sensors)
            In the order of time.

        Raises
        ------
        InputError
            For a wrong last axis or a code outside ``fmt``.
        """
        codes = self.fmt.check(frames, f"{self.entity} frames", self.sensors)
        return self.window.frames(codes).astype(np.int64)
