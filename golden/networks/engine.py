"""Engine: computes a whole scene with a program and one multiplier, or none."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np

from golden.common.block import Block
from golden.common.port import Port, Unsigned, input_port, output_port
from golden.engine.formats import DROPPED, HIDDEN
from golden.engine.frame_check import FrameCheck
from golden.engine.frame_guard import FrameGuard
from golden.engine.function_table import SEGMENT_WIDTH, joined, table_of
from golden.engine.graph import Graph
from golden.engine.image import Image, Sizes, image_of, own_image
from golden.engine.image_loader import ImageLoader
from golden.engine.integer_network import IntegerNetwork
from golden.engine.lane_groups import assign_to_lanes
from golden.engine.lane_pipeline import LanePipeline
from golden.engine.loop_schedule import shortest_loop
from golden.engine.multiply_accumulate import MultiplyAccumulate
from golden.engine.neurons import graph_of
from golden.engine.operand_memory import OperandMemory
from golden.engine.operand_select import OperandSelect
from golden.engine.pipeline import Pipeline, SerialPipeline
from golden.engine.plane_select import PlaneSelect
from golden.engine.program import SOURCE, Program, assemble
from golden.engine.program_memory import ProgramMemory
from golden.engine.program_ram import ProgramRam
from golden.engine.quantise import integer_networks
from golden.engine.ranges import Range
from golden.engine.replay_memory import ReplayMemory
from golden.engine.round_saturate import RoundSaturate
from golden.engine.serial_accumulate import SerialAccumulate
from golden.engine.serial_program import SerialProgram, assemble_serial
from golden.engine.table_address import TableAddress
from golden.input_error import InputError
from golden.networks.design import Design
from golden.networks.network import CHUNK
from golden.networks.settings import Settings
from golden.numbers.fixed import Codes
from golden.numbers.precision import EXACT
from golden.trained.dense import Trained
from golden.trained.function import TANH

MOST_LANES = 16
# Some devices build smaller memories from LUTs, which are slower behind a block RAM.
LEAST_ADDR_WIDTH = 7
# With fewer bits, Yosys repeats the test for saturation for each bit that it selects.
LEAST_ACC_WIDTH = 38
# So many bits hold the sums of any scene with weights below 512.
WHOLE_ACC_WIDTH = 44
LOAD_PORTS = (
    input_port("load_valid", "`load_data` holds a byte of an image"),
    input_port("load_data", "the byte", Unsigned(8)),
    input_port("load_last", "the byte is the last of the image"),
    output_port("load_ready", "a byte is taken in this clock; not while a frame is computed"),
    output_port("image_error", "the last image was not valid"),
)


# Of more functions than these, the largest error is that of all together.
NAMED = 8


@dataclass(frozen=True)
class Engine(Design):
    """Every neuron of a scene, one product per clock (ours; single, multiple and cascade alike).

    With ``lanes = 0`` the engine has no multiplier, and a product takes as many clocks as its
    operand has bits. With several lanes, or frames that overlap, it is a ``Lanes``. The results are
    the same.

    acc_width: Bits of the sum. All sums of the program fit in them.
    integers: The networks in whole numbers from which the graph was made.
    graph: The graph from which the program was made.
    loaded: The image that a reloadable engine runs; its hardware depends on ``loaded.sizes`` alone.
        None for a program that is part of the hardware.
    budget: The most clocks from the last sample to the last output that the scene allows; 0 for no
        limit.
    """

    block = "engine"
    arrangements: ClassVar[tuple[str, ...]] = ("single", "multiple", "cascade")
    together: ClassVar[tuple[str, ...]] = arrangements
    precisions = (EXACT.name,)
    known_activations = ("precise",)
    activation_choices = False
    most_nodes = (1 << SOURCE[1]) - 1
    options: ClassVar[tuple[str, ...]] = (
        "lanes",
        "segment_width",
        "pipeline",
        "clocks",
        "interval",
        "reload",
        "program_words",
        "operand_words",
        "table_blocks",
    )
    program: Program
    acc_width: int
    integers: tuple[IntegerNetwork, ...]
    graph: Graph
    loaded: Image | None = None
    budget: int = 0

    @classmethod
    def build(
        cls, networks: Sequence[Trained], settings: Settings, arrangement: str, variant: str
    ) -> Self:
        chosen: dict[str, Any] = {
            "segment_width": SEGMENT_WIDTH,
            "pipeline": "short",
            **settings.options,
        }
        lean, budget = settings.lean, chosen.pop("clocks", 0)
        if budget:
            left = replace(settings, options=chosen)
            return cls._within(budget, networks, left, arrangement, variant)
        lanes, interval = chosen.pop("lanes", 1), chosen.pop("interval", 0)
        if not 0 <= lanes <= MOST_LANES:
            raise InputError(f"hardware.lanes: got {lanes}, expected 0 to {MOST_LANES}")
        # That module needs this one.
        from golden.networks.lanes import Lanes

        several: Any = Lanes
        own = replace(settings, options={**chosen, "lanes": lanes, "interval": interval})
        if lanes > 1:
            many: Self = several.build(networks, own, arrangement, variant)
            return many
        serial = lanes == 0
        depth, reload = chosen.pop("pipeline"), chosen.pop("reload", False)
        if serial and depth != "short":
            raise InputError(
                f"hardware.pipeline: got {depth!r} with lanes 0, expected lanes 1 or more"
            )
        if serial and reload:
            raise InputError("hardware.reload: got true with lanes 0, expected lanes 1 or more")
        integers = integer_networks(arrangement, networks, settings.met, chosen["segment_width"])
        graph = cls.graph_for(integers, lean)
        # Straight functions alone need no table, so the width of its segments is any.
        table = joined(
            graph.functions, chosen["segment_width"] if graph.looks_up else SEGMENT_WIDTH
        )
        if lean and not reload:
            table = table.within(graph.reach(table))
        pipeline = Pipeline(int(depth == "deep"))
        acc_width = max(LEAST_ACC_WIDTH if lean else WHOLE_ACC_WIDTH, graph.sum_bits(table))
        loaded = None
        program: Program
        if reload:
            loaded = own_image(graph, Sizes, {**chosen, "pipeline": pipeline})
            program, acc_width = loaded.program, loaded.sizes.acc_width
        elif serial:
            program = assemble_serial(graph, table, SerialPipeline())
        else:
            program = assemble(graph, table, pipeline)
        built = cls(
            program,
            acc_width,
            integers,
            graph,
            loaded,
            useless_nodes=graph.useless_nodes,
            variant=variant,
        )
        if 0 < interval < built.interval and lanes:
            many = several.build(networks, own, arrangement, variant)
            return many
        return built

    @classmethod
    def _within(
        cls,
        clocks: int,
        networks: Sequence[Trained],
        settings: Settings,
        arrangement: str,
        variant: str,
    ) -> Self:
        """The smallest engine whose last output leaves at most ``clocks`` after the last sample."""
        chosen = settings.options
        # Without a multiplier there is one pipeline, no image, and no loop.
        fast = chosen["pipeline"] != "short" or chosen.get("reload")
        interval: Any = chosen.get("interval", 0)
        for lanes in [chosen["lanes"]] if "lanes" in chosen else [0, 1][bool(fast) :]:
            tried = replace(settings, options={**chosen, "lanes": lanes})
            engine = cls.build(networks, tried, arrangement, variant)
            late = not lanes and 0 < interval < engine.interval
            if engine.output_clocks[-1] <= clocks and not late:
                return replace(engine, budget=clocks)
        raise InputError(
            f"hardware.clocks: got {clocks}, expected {engine.output_clocks[-1]} or more, which "
            f"an engine with lanes = {lanes} takes"
        )

    @property
    def inputs(self) -> int:
        return self.program.inputs

    @cached_property
    def outputs(self) -> int:
        return len(self.output_clocks)

    @cached_property
    def output_clocks(self) -> tuple[int, ...]:
        """The clock in which each output leaves, counted from the last sample."""
        return tuple(map(self.program.clock, self.program.output_steps))

    @property
    def clocks_text(self) -> str:
        """``output_clocks`` as text for the exported file, which must not depend on an image."""
        return "as the image says" if self.loaded else ", ".join(map(str, self.output_clocks))

    @property
    def latency(self) -> int:
        return self.output_clocks[0]

    @property
    def interval(self) -> int:
        """Samples of a frame may come once the last output of the frame before has left."""
        return self.output_clocks[-1] + self.program.pipeline.free + self.inputs - 1

    @property
    def busy(self) -> int:
        return self.output_clocks[-1] + self.program.pipeline.free - 1

    @property
    def lanes(self) -> int:
        """The number of multipliers."""
        return int(not self.serial)

    @property
    def loops(self) -> bool:
        """Whether its program is a loop, in which frames overlap."""
        return False

    @property
    def options_built(self) -> Mapping[str, object]:
        return {"lanes": self.lanes}

    @property
    def shortest_interval(self) -> int:
        """That of the shortest loop that is found, or else its interval."""
        sums = any(layer.added for network in self.integers for layer in network.layers)
        if self.serial or self.loaded or sums:
            return self.interval
        pipeline = LanePipeline(self.program.pipeline.memory_registers)
        found = shortest_loop(assign_to_lanes(self.graph, 1), pipeline, self.interval)
        return found.length if found else self.interval

    @property
    def serial(self) -> bool:
        """Whether the engine works without a multiplier."""
        return isinstance(self.program, SerialProgram)

    @property
    def rectifies(self) -> bool:
        """Whether it has ReLU."""
        return self.program.rectifies

    @property
    def names_blocks(self) -> bool:
        """Whether steps say in which block of the table they look up."""
        return self.program.names_blocks

    @property
    def ports(self) -> tuple[Port, ...]:
        return super().ports + self.load_ports

    @property
    def load_ports(self) -> tuple[Port, ...]:
        return LOAD_PORTS if self.loaded else ()

    @property
    def image(self) -> bytes:
        return self.loaded.to_bytes() if self.loaded else b""

    def image_for(
        self,
        networks: Sequence[Trained],
        arrangement: str = "single",
        met: Sequence[Sequence[float]] = (),
    ) -> Image:
        """The image with which the same hardware computes other networks."""
        integers = integer_networks(arrangement, networks, met, self._sizes.segment_width)
        return image_of(self.graph_for(integers), self._sizes)

    @classmethod
    def graph_for(cls, integers: Sequence[IntegerNetwork], lean: bool = True) -> Graph:
        """The graph of networks that the design can compute."""
        return graph_of(integers, lean)

    def running(self, image: Image) -> Self:
        """The same hardware, running another image."""
        return replace(self, program=image.program, loaded=image)

    @property
    def addr_width(self) -> int:
        """Bits of the operand memory's address."""
        if self.loaded:
            return self.loaded.sizes.operand_addr_width
        return max(LEAST_ADDR_WIDTH, (self.program.addresses - 1).bit_length())

    @property
    def input_controller(self) -> FrameCheck:
        return self.frame_check

    @property
    def frame_check(self) -> FrameCheck:
        return FrameCheck(
            self.inputs, self.addr_width, self.output_clocks[-1], self.program.pipeline
        )

    @property
    def frame_guard(self) -> FrameGuard:
        """Replaces the frame check where the image can change."""
        return FrameGuard(self.addr_width, self.program.pipeline)

    @property
    def image_loader(self) -> ImageLoader:
        sizes = self._sizes
        return ImageLoader(sizes.words, self.addr_width, sizes.check_start)

    @property
    def program_ram(self) -> ProgramRam:
        """Replaces the program memory where the image can change."""
        return ProgramRam(
            self._sizes.program_addr_width,
            self._sizes.table_words,
            self.table_address.addr_width,
            self.program.pipeline.memory_registers,
        )

    @property
    def _sizes(self) -> Sizes:
        if self.loaded is None:
            raise InputError(f"{self.entity}: its program is part of the hardware, expected reload")
        return self.loaded.sizes

    @property
    def program_memory(self) -> ProgramMemory:
        return ProgramMemory(
            self.program.table,
            self.program.words,
            self.program.notes,
            self.table_address.addr_width,
            self.program.pipeline.memory_registers,
        )

    @property
    def operand_memory(self) -> OperandMemory:
        return OperandMemory(self.addr_width, self.program.pipeline.memory_registers)

    @property
    def table_address(self) -> TableAddress:
        width, kept = self.program.segment_width, self.program.segments
        whole = joined(self.graph.functions, width).segments
        every = 1 << (HIDDEN.width - 1 - width)
        return TableAddress(width, kept, kept == whole < every, self.program.blocks)

    @property
    def operand_select(self) -> OperandSelect:
        # The operand must be as late as the word of the table.
        return OperandSelect(self.program.segment_width, self.program.pipeline.table)

    @property
    def multiply_accumulate(self) -> MultiplyAccumulate:
        return MultiplyAccumulate(self.acc_width)

    @property
    def round_saturate(self) -> RoundSaturate:
        return RoundSaturate(self.acc_width, self.rectifies, self.program.cut, self.program.even)

    @property
    def replay_memory(self) -> ReplayMemory:
        """Replaces ``program_memory`` where there is no multiplier."""
        return ReplayMemory(
            self.program.table,
            self.program.words,
            self.program.notes,
            self.table_address.addr_width + 1,
        )

    @property
    def plane_select(self) -> PlaneSelect:
        """Replaces ``operand_select`` where there is no multiplier."""
        return PlaneSelect(self.program.segment_width)

    @property
    def serial_accumulate(self) -> SerialAccumulate:
        """Replaces ``multiply_accumulate`` where there is no multiplier."""
        return SerialAccumulate(self.acc_width)

    @property
    def steps(self) -> tuple[Block, ...]:
        """The blocks that read the program, choose the operands and add the products up."""
        if self.serial:
            return self.replay_memory, self.plane_select, self.serial_accumulate
        return self.program_memory, self.operand_select, self.multiply_accumulate

    def parts(self) -> tuple[Block, ...]:
        program, select, accumulate = self.steps
        control: tuple[Block, ...] = (self.frame_check, program)
        if self.loaded:
            control = (self.image_loader, self.frame_guard, self.program_ram)
        return (
            *control,
            self.operand_memory,
            self.table_address,
            select,
            accumulate,
            self.round_saturate,
        )

    def facts(self) -> tuple[str, ...]:
        multiplier = "no multiplier" if self.serial else "one multiplier"
        budget = f" of {self.budget}" if self.budget else ""
        spent = f"{self.output_clocks[-1]}{budget} clocks from the last sample to the last output"
        return multiplier, spent, *self.function_facts

    @property
    def function_facts(self) -> tuple[str, ...]:
        """The largest error of each function; none where there is no other than tanh."""
        if self.graph.functions == (TANH,):
            return ()
        errors = {
            function: table_of(function, self.program.segment_width).error
            for function in self.graph.functions
        }
        if len(errors) > NAMED:
            return (f"largest error of {len(errors)} functions: {max(errors.values()):.2g}",)
        texts = (f"{function.name} {error:.2g}" for function, error in errors.items())
        return (f"largest errors of functions: {', '.join(texts)}",)

    def compute(self, frames: Codes) -> Codes:
        return self.program.execute(frames)

    @property
    def ranges(self) -> tuple[Range, ...]:
        return self.graph.ranges

    def saturations(self, frames: Codes) -> dict[str, Codes]:
        ranges = [one for one in self.graph.ranges if one.from_data]
        counts = {one.layer: np.zeros(len(frames), dtype=np.int64) for one in ranges}
        if not ranges:
            return counts
        layers = {place: one.layer for one in ranges for place in one.places}
        for start in range(0, len(frames), CHUNK):
            part = slice(start, start + CHUNK)
            for place, relu, sums, word in self.program.stored(self.graph, frames[part]):
                if place in layers:
                    found = sums >> DROPPED
                    counts[layers[place]][part] += (found > word) | ((found < word) & (not relu))
        return counts
