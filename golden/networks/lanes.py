"""Lanes: computes a whole scene with a program and several multipliers that work side by side."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from golden.common.block import Block
from golden.engine.frame_check import FrameCheck
from golden.engine.function_table import SEGMENT_WIDTH, joined
from golden.engine.graph import Graph
from golden.engine.image import own_image
from golden.engine.integer_network import IntegerNetwork
from golden.engine.lane_accumulate import LaneAccumulate
from golden.engine.lane_groups import assign_to_lanes
from golden.engine.lane_image import LaneSizes
from golden.engine.lane_memory import LaneMemory
from golden.engine.lane_pipeline import LanePipeline
from golden.engine.lane_program import LaneProgram, assemble_lanes
from golden.engine.lane_round import LaneRound
from golden.engine.loop_program import LoopProgram, assemble_loop
from golden.engine.loop_schedule import shortest_loop
from golden.engine.operand_memory import OperandMemory
from golden.engine.program_memory import ProgramMemory
from golden.engine.program_ram import ProgramRam
from golden.engine.quantise import integer_networks
from golden.input_error import InputError
from golden.networks.engine import (
    LEAST_ACC_WIDTH,
    LEAST_ADDR_WIDTH,
    MOST_LANES,
    WHOLE_ACC_WIDTH,
    Engine,
)
from golden.networks.settings import Settings
from golden.numbers.fixed import Codes
from golden.trained.dense import Trained

LANES = 2


@dataclass(frozen=True)
class Lanes(Engine):
    """Every neuron of a scene, one product of each lane per clock (ours).

    It is what ``Engine`` builds for several lanes, or for frames that overlap.

    The neurons, their formats and so the results are those of ``Engine``.

    acc_width, integers, graph, loaded: See ``Engine``.
    asked: The lanes that the scene asks for. No more are built than a layer has nodes for.
    """

    block = "lanes"
    arrangements: ClassVar[tuple[str, ...]] = ()
    options: ClassVar[tuple[str, ...]] = (
        "lanes",
        "segment_width",
        "pipeline",
        "interval",
        "reload",
        "program_words",
        "operand_words",
        "table_blocks",
    )
    program: LaneProgram
    asked: int = LANES

    @classmethod
    def build(
        cls, networks: Sequence[Trained], settings: Settings, arrangement: str, variant: str
    ) -> Self:
        chosen: dict[str, Any] = {
            "lanes": LANES,
            "segment_width": SEGMENT_WIDTH,
            "pipeline": "short",
            **settings.options,
        }
        lanes, width = chosen["lanes"], chosen["segment_width"]
        reload, asked = chosen.pop("reload", False), chosen.pop("interval", 0)
        if not 1 <= lanes <= MOST_LANES:
            raise InputError(f"hardware.lanes: got {lanes}, expected 1 to {MOST_LANES}")
        integers = integer_networks(arrangement, networks, settings.met, width)
        graph = cls.graph_for(integers, settings.lean)
        pipeline = LanePipeline(int(chosen.pop("pipeline") == "deep"))
        loaded = None
        if reload:
            loaded = own_image(graph, LaneSizes, {**chosen, "pipeline": pipeline})
            acc_width = loaded.sizes.acc_width
            program = loaded.program
            assert isinstance(program, LaneProgram)
            program = replace(program, shared=assign_to_lanes(graph, lanes, every=True))
        else:
            table = joined(graph.functions, width)
            if settings.lean:
                table = table.within(graph.reach(table))
            least = LEAST_ACC_WIDTH if settings.lean else WHOLE_ACC_WIDTH
            acc_width = max(least, graph.sum_bits(table))
            program = assemble_lanes(graph, table if graph.looks_up else None, lanes, pipeline)
        built = cls(
            program,
            acc_width,
            integers,
            graph,
            loaded,
            asked=lanes,
            useless_nodes=graph.useless_nodes,
            variant=variant,
        )
        interval = asked or built.interval
        if interval >= built.interval:
            return built
        if built.loaded:
            raise InputError(
                f"hardware.interval: got {interval} with reload, expected {built.interval} or more"
            )
        return replace(built, program=assemble_loop(built.program, graph, interval))

    @classmethod
    def graph_for(cls, integers: Sequence[IntegerNetwork], lean: bool = True) -> Graph:
        if any(layer.added for network in integers for layer in network.layers):
            raise InputError(
                "hardware.lanes: got several for sums of functions, expected 1 or 0, which look up "
                "one function after the other"
            )
        return super().graph_for(integers, lean)

    @property
    def lanes(self) -> int:
        """The number of lanes, each of which has a multiplier."""
        return self.program.lanes

    @property
    def loops(self) -> bool:
        """Whether its program is a loop, in which frames overlap."""
        return isinstance(self.program, LoopProgram)

    @property
    def interval(self) -> int:
        return (
            self.program.loop.length if isinstance(self.program, LoopProgram) else super().interval
        )

    @property
    def busy(self) -> int:
        return self.interval - self.inputs if self.loops else super().busy

    def begun(self, ended: Codes) -> Codes:
        if not isinstance(self.program, LoopProgram):
            return ended
        length, computed = self.interval, self.interval * self.program.stages
        found: list[int] = []
        for clock in ended.tolist():
            before = found[-1] if found else clock - computed
            late = clock - before
            found.append(clock if late >= computed else before - late // -length * length)
        return np.array(found, dtype=np.int64)

    @property
    def frame_check(self) -> FrameCheck:
        if not self.loops:
            return super().frame_check
        width = self.inputs.bit_length()
        return FrameCheck(self.inputs, width, self.busy, LanePipeline(), results=False)

    @property
    def sample_memory(self) -> OperandMemory:
        """Keeps the frame that comes and the one before, in a loop."""
        return OperandMemory(self.inputs.bit_length() + 1, variant="samples")

    @property
    def source_width(self) -> int:
        """Bits of the address of an operand in a word of the program."""
        if isinstance(self.program, LoopProgram):
            return self.program.layout.source_width
        return self.addr_width

    @property
    def addr_width(self) -> int:
        if isinstance(self.program, LoopProgram):
            layout = self.program.layout
            return max(LEAST_ADDR_WIDTH, layout.source_width + layout.turn_width)
        return super().addr_width

    @property
    def options_built(self) -> Mapping[str, object]:
        built = {"lanes": self.lanes}
        return {**built, "interval": self.interval} if self.loops else built

    @property
    def shortest_interval(self) -> int:
        """That of the shortest loop that is found, or else its interval."""
        program, most = self.program, self.interval
        assert isinstance(program.pipeline, LanePipeline)
        found = shortest_loop(program.shared, program.pipeline, most)
        return found.length if found else most

    @property
    def looks_up(self) -> bool:
        """Whether there is a table."""
        return bool(self.program.table)

    @property
    def program_memory(self) -> ProgramMemory:
        program = self.program
        registers = program.pipeline.memory_registers
        return ProgramMemory((), program.words, program.notes, 1, registers)

    @property
    def program_ram(self) -> ProgramRam:
        registers = self.program.pipeline.memory_registers
        return ProgramRam(self._sizes.program_addr_width, 0, 0, registers)

    @property
    def lane_memories(self) -> tuple[LaneMemory, ...]:
        """The weights of each lane, and its table."""
        program = self.program
        if self.loaded:
            room = LaneMemory.empty(
                self.loaded.sizes.program_words,
                self.loaded.sizes.table_words,
                program.segment_width,
                program.blocks,
            )
            return (replace(room, variant=self.variant),) * self.lanes
        return tuple(
            LaneMemory(
                tuple(row[lane] for row in program.weights),
                program.table,
                program.segment_width,
                tuple(program.weight_notes(self.graph, lane)),
                program.blocks,
                variant=f"{self.variant}_{lane}" if self.variant else str(lane),
            )
            for lane in range(self.lanes)
        )

    @property
    def accumulators(self) -> tuple[LaneAccumulate, ...]:
        """What multiplies and adds up in each lane."""
        width = self.program.segment_width if self.looks_up else 0
        return tuple(
            LaneAccumulate.of_lane(self.acc_width, width, lane, self.lanes, self.variant)
            for lane in range(self.lanes)
        )

    @property
    def rounds(self) -> tuple[LaneRound, ...]:
        """What turns the sum of each lane into a word."""
        names = ["lead"] + ["other"] * (self.lanes - 1)
        return tuple(
            LaneRound(
                self.acc_width,
                self.rectifies,
                name == "lead",
                self.program.cut,
                self.program.even,
                variant=f"{self.variant}_{name}" if self.variant else name,
            )
            for name in names
        )

    def parts(self) -> tuple[Block, ...]:
        control: tuple[Block, ...] = (self.frame_check, self.program_memory)
        if self.loaded:
            control = (self.image_loader, self.frame_guard, self.program_ram)
        return (
            *control,
            *([self.sample_memory] if self.loops else []),
            *[self.operand_memory] * self.lanes,
            *self.lane_memories,
            *self.accumulators,
            *self.rounds,
        )

    def facts(self) -> tuple[str, ...]:
        spent = f"{self.output_clocks[-1]} clocks from the last sample to the last output"
        facts = (f"{self.lanes} multipliers", spent, *self.function_facts)
        return (*facts, f"a frame every {self.interval} clocks") if self.loops else facts
