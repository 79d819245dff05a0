"""CONTROLLER 1: counts the samples of a frame and refuses frames of a wrong length."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.common.block import Block
from golden.common.border import Border, State
from golden.common.port import CLOCKED, Port, Unsigned, input_port, output_port
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


@dataclass(frozen=True)
class InputController(Block):
    """Weight address, accumulator controls and frame check (thesis 5.4.5.1, CONTROLLER 1).

    inputs: Samples of one frame, 1 or more.
    spacing: Least clocks from the last sample of one frame to the last sample of the next. A design
        whose outputs or activations need more clocks than a frame has samples sets it to that
        number of clocks; otherwise it is 0 and its counter is left out.

    Frames are judged as in ``judge``. The name of the entity contains ``inputs`` and ``spacing``,
    so that controllers of equal frames are one entity.
    """

    block = "input_controller"
    section = "5.4.5.1"
    area = "layers"
    # One clock each for operands, product, accumulator, and output of the nodes that it
    # controls.
    latency = 4
    inputs: int
    spacing: int

    def __post_init__(self) -> None:
        self.check(inputs=(1, None), spacing=(0, None))

    @classmethod
    def every(cls, interval: int, inputs: int) -> Self:
        """The controller of frames that are at least ``interval`` clocks apart."""
        return cls(inputs, interval if interval > inputs else 0)

    @property
    def entity(self) -> str:
        name = f"{super().entity}_of_{self.inputs}"
        return f"{name}_every_{self.spacing}" if self.spacing else name

    @property
    def addr_width(self) -> int:
        return max(1, (self.inputs - 1).bit_length())

    @property
    def ports(self) -> tuple[Port, ...]:
        return (
            *JUDGED,
            output_port(
                "addr",
                "position of the sample in its frame, in the same clock",
                Unsigned(self.addr_width, last=self.inputs - 1),
            ),
            output_port("preset", "two clocks after the first sample of a frame"),
            output_port("accumulate", "two clocks after each accepted sample"),
            output_port("capture", "three clocks after the last sample of a good frame"),
            output_port(
                "out_valid",
                "four clocks after the last sample: the nodes hold the sums of the frame",
            ),
            BROKEN,
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

    def facts(self) -> tuple[str, ...]:
        return (f"{self.inputs} element{'s' if self.inputs > 1 else ''} a frame",)

    def process(self, last: ArrayLike, clock: ArrayLike) -> FrameScan:
        """Decisions for samples that arrive after a reset; see ``judge``."""
        return judge(last, clock, self.inputs, self.spacing)
