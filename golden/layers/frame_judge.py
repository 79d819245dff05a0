"""The decision which frames are good, for every block that makes it."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.common.port import CLOCKED, input_port, output_port
from golden.numbers.fixed import Codes

# The ports of the stream that is judged, and the port that reports a wrong frame.
JUDGED = (
    *CLOCKED,
    input_port("in_valid", "the stream holds a sample"),
    input_port("in_last", "the sample is the last of its frame; ignored without `in_valid`"),
)
BROKEN = output_port(
    "frame_error", "high for one clock, one clock after the sample that breaks a frame"
)


@dataclass(frozen=True)
class FrameScan:
    """The decision about each sample, as arrays of equal length.

    addr: Position of the sample in its frame, 0 where the sample is dropped.
    accept: False where the sample is dropped.
    done: The sample completes a frame that yields a result.
    error: The sample breaks the frame, so ``frame_error`` follows for one clock.
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
        """Decisions for elements that arrive after a reset; see ``judge``."""


def judge(
    last: ArrayLike, clock: ArrayLike, inputs: int, apart: int, *, at_once: bool = False
) -> FrameScan:
    """Decisions for samples that arrive after a reset.

    A frame is wrong when ``last`` comes too early or does not come with the last sample, or when it
    comes too soon after a good one. A wrong frame raises one error; of an overlong frame everything
    up to and including its ``last`` is dropped.

    last: The ``last`` flag of each valid sample.
    clock: The clock in which each sample arrived; only differences matter.
    inputs: Samples of a good frame.
    apart: Least clocks from the last sample of a good frame to the last sample of the next.
    at_once: Count these clocks to the first sample of the next frame instead. A sample that comes
        too early is dropped together with its whole frame.
    """
    flags = np.asarray(last, dtype=bool)
    times = np.asarray(clock, dtype=np.int64)
    addr = np.zeros(len(flags), dtype=np.int64)
    accept, done, error = (np.zeros(len(flags), dtype=bool) for _ in range(3))
    count, dropping, free_at = 0, False, None
    for k, (is_last, time) in enumerate(zip(flags, times, strict=True)):
        early = free_at is not None and time < free_at
        if dropping or (early and at_once):
            error[k] = not dropping
            dropping = not is_last
            continue
        accept[k], addr[k] = True, count
        complete = count == inputs - 1
        done[k] = complete and is_last and not early
        error[k] = (complete or is_last) and not done[k]
        dropping = complete and not is_last
        count = 0 if complete or is_last else count + 1
        if done[k]:
            free_at = time + apart
    return FrameScan(addr, accept, done, error)
