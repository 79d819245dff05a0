"""frame_check and frame_guard: accept samples of good frames, and signal when the engine runs."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.common.block import Block
from golden.common.port import Port, Unsigned, input_port, output_port
from golden.engine.pipeline import Pipeline
from golden.layers.input_controller import BROKEN, JUDGED, FrameScan, judge


@dataclass(frozen=True)
class FrameCheck(Block):
    """Counts samples and results, and starts the program after a good frame.

    inputs: Samples of a frame, 1 or more.
    addr_width: Bits of the operand memory's address.
    busy: Clocks from a frame's last sample to its last output, or to another ``finish``.
    results: Whether it counts results too, behind the samples of their frame.

    Frames are judged as in ``judge``; none begins while the frame before is computed. A sample that
    breaks a frame that was begun goes to the last address, where nothing else is kept.
    """

    block = "frame_check"
    part_of = "engine"
    area = "engine"
    latency = 1
    inputs: int
    addr_width: int
    busy: int
    pipeline: Pipeline
    results: bool = True

    def __post_init__(self) -> None:
        self.check(inputs=(1, (1 << self.addr_width) - 1))

    @property
    def ports(self) -> tuple[Port, ...]:
        store = input_port("store", "a result is ready; only while `run` is high")
        return (
            *JUDGED,
            *((store,) if self.results else ()),
            input_port("finish", "the last output of the frame leaves"),
            output_port("start", "the program's first step is done in the next clock"),
            output_port("run", "a frame is computed"),
            output_port("write", "high one clock after an accepted sample or a result"),
            output_port(
                "write_addr", "address of that sample or result", Unsigned(self.addr_width)
            ),
            BROKEN,
        )

    def facts(self) -> tuple[str, ...]:
        return (f"{self.inputs} sample{'s' if self.inputs > 1 else ''} a frame",)

    def process(self, last: ArrayLike, clock: ArrayLike) -> FrameScan:
        """Decisions for samples that arrive after a reset; see ``judge``."""
        apart = self.busy + self.pipeline.free
        scan = judge(last, clock, self.inputs, apart, at_once=True)
        # A sample that breaks a frame goes where nothing else is kept.
        aside = (1 << self.addr_width) - 1
        return replace(scan, addr=np.where(scan.accept & scan.error, aside, scan.addr))


@dataclass
class Stream:
    """A stream whose frames have a number of elements: a frame of another length is broken.

    count: Elements of the frame so far.
    began, dropping: Whether a frame has begun, and whether the rest of it is dropped.
    raised: Whether the element of the clock before broke its frame.
    """

    count: int = 0
    began: bool = False
    dropping: bool = False
    raised: bool = False

    def take(self, valid: bool, last: bool, refused: bool, length: int) -> tuple[int, bool]:
        """The number of the element that is accepted, or -1; and whether its frame is good.

        refused: Whether nothing is accepted, and a frame that has begun is broken.
        length: How many elements a frame has.
        """
        accept = valid and not refused and not self.dropping
        breaks = refused and (valid or self.began) and not self.dropping
        complete = self.count == length - 1
        wrong = accept and complete != last
        number, done = self.count if accept else -1, accept and complete and last
        self.raised = breaks or wrong
        if valid:
            self.dropping = not last and (self.dropping or self.raised)
            self.began = not last
        elif breaks:
            self.dropping = True
        self.count = 0 if wrong or done or refused else self.count + accept
        return number, done


@dataclass(frozen=True)
class Guarded:
    """What leaves the design in each clock, and which samples complete a good frame.

    busy, frame_error: The ports of these names.
    done: The sample of this clock completes a frame that the engine then computes.
    """

    busy: NDArray[np.bool_]
    frame_error: NDArray[np.bool_]
    done: NDArray[np.bool_]


@dataclass(frozen=True)
class FrameGuard(Block):
    """Counts samples and results, and starts the program after a good frame of a good image.

    addr_width: Bits of the operand memory's address.

    A frame is wrong when ``last`` comes too early or does not come with the last sample, when its
    first sample comes while the frame before is computed, and when any clock from its first sample
    to its last falls on ``halt``. A wrong frame raises one error; everything from the clock that
    breaks it up to and including its ``last`` is dropped. ``halt`` never comes while a frame is
    computed, because ``image_loader`` takes no byte then.
    """

    block = "frame_guard"
    part_of = "engine"
    area = "engine"
    latency = 1
    addr_width: int
    pipeline: Pipeline

    @property
    def ports(self) -> tuple[Port, ...]:
        addr = Unsigned(self.addr_width)
        return (
            *JUDGED,
            input_port("halt", "no frame is accepted; never high while `busy` is"),
            input_port("before_last", "samples of a frame minus 2", addr),
            input_port("store", "a result is ready; only while `run` is high"),
            input_port("finish", "the last output of the frame leaves"),
            output_port("start", "the program's first step is done in the next clock"),
            output_port("run", "a frame is computed"),
            output_port("busy", "a frame is being computed or is about to be"),
            output_port("write", "high one clock after an accepted sample or a result"),
            output_port("write_addr", "address of that sample or result", addr),
            output_port("frame_error", "high for one clock, one clock after what breaks a frame"),
        )

    def process(
        self,
        in_valid: ArrayLike,
        in_last: ArrayLike,
        halt: ArrayLike,
        before_last: ArrayLike,
        finish: ArrayLike,
        reset: ArrayLike,
    ) -> Guarded:
        """Whether it is busy, and what it decides, in each clock from a reset on."""
        inputs = (in_valid, in_last, halt, before_last, finish, reset)
        columns = [np.asarray(column).tolist() for column in inputs]
        busy, error, done = (np.zeros(len(columns[0]), dtype=bool) for _ in range(3))
        computes, stream = False, Stream()
        for t, (valid, last, halts, before, ends, clears) in enumerate(zip(*columns, strict=True)):
            busy[t], error[t] = computes, stream.raised
            length = (before + 1) % (1 << self.addr_width) + 1
            _, good = stream.take(valid, last, bool(halts or (valid and computes)), length)
            done[t] = good and not clears
            computes = done[t] or (computes and not (ends or clears))
            if clears:
                stream = Stream()
        return Guarded(busy, error, done)
