"""SerialEngine: computes a whole scene with a program and without a multiplier."""

from dataclasses import dataclass
from typing import ClassVar

from golden.common.block import Block
from golden.engine.formats import HIDDEN
from golden.engine.function_table import joined
from golden.engine.plane_select import PlaneSelect
from golden.engine.replay_memory import ReplayMemory
from golden.engine.round_saturate import RoundSaturate
from golden.engine.serial_accumulate import SerialAccumulate
from golden.engine.serial_program import SerialProgram
from golden.engine.table_address import TableAddress
from golden.networks.engine import Engine


@dataclass(frozen=True)
class SerialEngine(Engine):
    """Every neuron of a scene; a product takes as many clocks as its operand has bits (ours).

    It is what ``Engine`` builds for no lanes, and a scene does not name it.
    """

    block = "serial_engine"
    arrangements: ClassVar[tuple[str, ...]] = ()
    program: SerialProgram  # type: ignore[assignment]

    @property
    def serial(self) -> bool:
        return True

    @property
    def lanes(self) -> int:
        return 0

    @property
    def shortest_interval(self) -> int:
        return self.interval

    @property
    def table_address(self) -> TableAddress:
        width, kept = self.program.segment_width, self.program.segments
        whole = joined(self.graph.functions, width).segments
        every = 1 << (HIDDEN.width - 1 - width)
        return TableAddress(width, kept, kept == whole < every, self.program.blocks)

    @property
    def round_saturate(self) -> RoundSaturate:
        return RoundSaturate(self.acc_width, self.rectifies, self.program.cut, self.program.even)

    @property
    def replay_memory(self) -> ReplayMemory:
        return ReplayMemory(
            self.program.words,
            self.program.notes,
            self.program.table,
            segment_addr_width=self.table_address.addr_width + 1,
        )

    @property
    def plane_select(self) -> PlaneSelect:
        return PlaneSelect(self.program.segment_width)

    @property
    def serial_accumulate(self) -> SerialAccumulate:
        return SerialAccumulate(self.acc_width)

    def parts(self) -> tuple[Block, ...]:
        return (
            self.frame_check,
            self.replay_memory,
            self.operand_memory,
            self.table_address,
            self.plane_select,
            self.serial_accumulate,
            self.round_saturate,
        )
