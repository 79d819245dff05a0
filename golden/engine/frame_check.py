"""frame_check: accepts samples of good frames, rejects others, and signals when the engine runs."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from golden.common.block import Block
from golden.common.port import Port, Unsigned, input_port, output_port
from golden.engine.pipeline import Pipeline
from golden.input_error import InputError
from golden.layers.input_controller import BROKEN, JUDGED, FrameScan, judge


@dataclass(frozen=True)
class FrameCheck(Block):
    """Counts samples and results, and starts the program after a good frame.

    inputs: Samples of a frame, 1 or more.
    addr_width: Bits of the operand memory's address.
    busy: Clocks from a frame's last sample to its last output, or to another ``finish``.
    results: Whether it counts results too, behind the samples of their frame.

    A frame is wrong when ``last`` comes too early or does not come with the last sample, or when
    its first sample comes while the frame before is computed. A wrong frame raises one error;
    everything from the sample that breaks it up to and including its ``last`` is dropped. A sample
    that breaks a frame that was begun goes to the last address, where nothing else is kept.
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
        if not 1 <= self.inputs < 1 << self.addr_width:
            raise InputError(
                f"{self.entity}: got inputs={self.inputs}, expected 1 to "
                f"{(1 << self.addr_width) - 1} with addresses of {self.addr_width} bits"
            )

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
                "write_addr",
                "address of that sample or result",
                Unsigned(self.addr_width),
                "addr_width",
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
