"""CONTROLLER 1: counts the samples of a frame and refuses frames of a wrong length."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.block import Block
from golden.border import Border, State
from golden.fixed import Codes
from golden.input_error import InputError
from golden.port import CLOCKED, Port, Unsigned, given, taken


@dataclass(frozen=True)
class FrameScan:
    """The controller's decision about each sample, as arrays of equal length.

    Attributes
    ----------
    addr : int64 array
        Position of the sample in its frame, 0 where the sample is dropped.
    accept : bool array
        False for the samples of an overlong frame that are dropped.
    done : bool array
        The sample completes a frame that yields results.
    error : bool array
        The sample breaks the frame, so ``frame_error`` follows for one clock.
    """

    addr: Codes
    accept: NDArray[np.bool_]
    done: NDArray[np.bool_]
    error: NDArray[np.bool_]


class FrameJudge(Protocol):
    """A block that decides which frames a network accepts."""

    @property
    def inputs(self) -> int:
        """Number of elements of a good frame."""

    def process(self, last: ArrayLike, clock: ArrayLike) -> FrameScan:
        """Decisions for elements that arrive after a reset; see ``InputController.process``."""


@dataclass(frozen=True)
class InputController(Block):
    """Weight address, accumulator controls and frame check (thesis 5.4.5.1, CONTROLLER 1).

    Parameters
    ----------
    inputs : int
        Samples of one frame, 1 or more.
    spacing : int
        Least clocks from the last sample of one frame to the last sample of the next. A design
        whose outputs or activations need more clocks than a frame has samples sets it to that
        number of clocks; otherwise it is 0 and its counter is left out.

    Notes
    -----
    A frame is wrong when ``last`` comes too early or does not come with the last sample, or when
    the frame ends before ``spacing`` clocks have passed. A wrong frame raises one error. Of an
    overlong frame everything up to and including its ``last`` is dropped.

    The name of the entity contains ``inputs`` and ``spacing``, so that controllers of equal frames
    are one entity.
    """

    block = "input_controller"
    section = "5.4.5.1"
    area = "layers"
    inputs: int
    spacing: int

    def __post_init__(self) -> None:
        if self.inputs < 1 or self.spacing < 0:
            raise InputError(
                f"{self.entity}: got inputs={self.inputs}, spacing={self.spacing}, "
                "expected inputs of 1 or more and spacing of 0 or more"
            )

    @property
    def entity(self) -> str:
        name = f"{super().entity}_of_{self.inputs}"
        return f"{name}_every_{self.spacing}" if self.spacing else name

    @property
    def addr_width(self) -> int:
        """Bits of the weight address."""
        return max(1, (self.inputs - 1).bit_length())

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *CLOCKED,
            taken("in_valid", "the stream holds a sample"),
            taken("in_last", "the sample is the last of its frame; ignored without `in_valid`"),
            given(
                "addr",
                "position of the sample in its frame, in the same clock",
                Unsigned(self.addr_width, last=self.inputs - 1),
                "addr_width",
            ),
            given("preset", "two clocks after the first sample of a frame"),
            given("accumulate", "two clocks after each accepted sample"),
            given("capture", "three clocks after the last sample of a good frame"),
            given(
                "out_valid",
                "four clocks after the last sample: the nodes hold the sums of the frame",
            ),
            given(
                "frame_error", "high for one clock, one clock after the sample that breaks a frame"
            ),
        )

    @property
    def borders(self) -> tuple[Border, ...]:
        if not self.spacing:
            return ()
        return (Border("far enough apart", "clocks from frame to frame", self.spacing),)

    @property
    def states(self) -> tuple[State, ...]:
        return (
            State("samples before, in a frame that is taken", range(self.inputs)),
            State("dropping", range(2)),
        )

    @property
    def latency(self) -> int:
        # One clock each for operands, product, accumulator, and output of the nodes that it
        # controls.
        return 4

    def facts(self) -> tuple[str, ...]:
        return (f"{self.inputs} element{'s' if self.inputs > 1 else ''} a frame",)

    def process(self, last: ArrayLike, clock: ArrayLike) -> FrameScan:
        """Decisions for samples that arrive after a reset.

        Parameters
        ----------
        last : array_like of bool
            The ``last`` flag of each valid sample.
        clock : array_like of int
            The clock in which each sample arrived; only differences matter.
        """
        flags = np.asarray(last, dtype=bool)
        times = np.asarray(clock, dtype=np.int64)
        addr = np.zeros(len(flags), dtype=np.int64)
        accept = np.ones(len(flags), dtype=bool)
        done = np.zeros(len(flags), dtype=bool)
        error = np.zeros(len(flags), dtype=bool)
        count, dropping, free_at = 0, False, None
        for k, (is_last, time) in enumerate(zip(flags, times, strict=True)):
            if dropping:
                accept[k] = False
                dropping = not is_last
                continue
            addr[k] = count
            complete = count == self.inputs - 1
            early = free_at is not None and time < free_at
            done[k] = complete and is_last and not early
            error[k] = (complete or is_last) and not done[k]
            dropping = complete and not is_last
            count = 0 if complete or is_last else count + 1
            if done[k]:
                free_at = time + self.spacing
        return FrameScan(addr, accept, done, error)
