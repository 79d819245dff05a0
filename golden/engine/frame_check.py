"""frame_check and frame_guard: accept samples of good frames, and signal when the engine runs."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from golden.common.block import Block
from golden.common.port import Port, Unsigned, input_port, output_port
from golden.engine.pipeline import Pipeline
from golden.layers.input_controller import BROKEN, JUDGED, FrameScan, judge
from golden.numbers.fixed import Codes


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


@dataclass(frozen=True)
class Guarded:
    """The outputs in each clock, and which samples complete a good frame.

    done: The sample of this clock completes a frame that the engine then computes.
    """

    start: NDArray[np.bool_]
    run: NDArray[np.bool_]
    busy: NDArray[np.bool_]
    write: NDArray[np.bool_]
    write_addr: Codes
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
        store: ArrayLike,
        finish: ArrayLike,
        reset: ArrayLike,
    ) -> Guarded:
        """The outputs in each clock, from a reset on."""
        columns = [
            np.asarray(c).tolist()
            for c in (in_valid, in_last, halt, before_last, store, finish, reset)
        ]
        count, span = len(columns[0]), 1 << self.addr_width
        start, run, busy, write, error, done = (np.zeros(count, dtype=bool) for _ in range(6))
        write_addr = np.zeros(count, dtype=np.int64)
        addr, running, begins = span - 1, False, -1
        inside = dropping = wrote = raised = False
        for t, (valid, last, halts, before, stores, ends, clears) in enumerate(
            zip(*columns, strict=True)
        ):
            running = running or t == begins
            run[t], busy[t] = running, running or begins > t
            write[t], write_addr[t], error[t] = wrote, addr, raised
            accept = valid and not (busy[t] or halts or dropping)
            refused = not dropping and ((valid and busy[t]) or (halts and (valid or inside)))
            complete = addr == before
            broken = accept and complete != last
            done[t] = accept and complete and last and not clears
            wrote = accept or stores
            raised = refused or broken
            if valid:
                dropping = not last and (dropping or raised)
                inside = not last
            elif refused:
                dropping = True
            if ends or broken or halts:
                addr = span - 1
            elif wrote:
                addr = (addr + 1) % span
            if ends:
                running = False
            if done[t]:
                begins = t + self.pipeline.run
            start[t] = begins == t + 1
            if clears:
                addr, running, begins = span - 1, False, -1
                inside = dropping = wrote = raised = False
        return Guarded(start, run, busy, write, write_addr, error, done)
