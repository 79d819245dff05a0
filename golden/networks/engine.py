"""Engine: computes a whole scene with a program and multipliers that work side by side."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np

from golden.common.block import Block
from golden.common.flow import Flow, Step, Wire
from golden.common.port import Port, Unsigned, input_port, output_port
from golden.engine.datapath import LaneAccumulate, LaneRound
from golden.engine.formats import DROPPED, OUTPUT_SHIFT, WORD
from golden.engine.frame_check import FrameCheck, FrameGuard
from golden.engine.function_table import SEGMENT_WIDTH, joined, table_of
from golden.engine.graph import Graph
from golden.engine.image import Image, Sizes, image_of, own_image
from golden.engine.image_loader import ImageLoader
from golden.engine.integer_network import IntegerNetwork
from golden.engine.lane_groups import assign_to_lanes
from golden.engine.lane_program import FIELDS, LaneProgram, assemble_lanes
from golden.engine.memories import LaneMemory, OperandMemory, ProgramMemory, ProgramRam
from golden.engine.neurons import graph_of
from golden.engine.pipeline import Pipeline
from golden.engine.quantise import integer_networks
from golden.engine.ranges import Range
from golden.input_error import InputError
from golden.networks.design import Design, Settings
from golden.networks.network import CHUNK
from golden.numbers.fixed import Codes
from golden.numbers.precision import EXACT, SIGNAL
from golden.trained.dense import DenseNetwork
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
    """Every neuron of a scene, one product of each lane per clock (ours).

    It takes single, multiple and cascade alike. A lane has a multiplier.

    acc_width: Bits of the sum. All sums of the program fit in them.
    integers: The networks in whole numbers from which the graph was made.
    graph: The graph from which the program was made.
    loaded: The image that a reloadable engine runs; its hardware depends on ``loaded.sizes`` alone.
        None for a program that is part of the hardware.
    asked: The lanes that the scene asks for. No more are built than a layer has nodes for.
    """

    block = "engine"
    arrangements: ClassVar[tuple[str, ...]] = ("single", "multiple", "cascade")
    together: ClassVar[tuple[str, ...]] = arrangements
    precisions = (EXACT.name,)
    known_activations = ("precise",)
    activation_choices = False
    most_nodes = (1 << FIELDS["source"][1]) - 1
    options: ClassVar[tuple[str, ...]] = (
        "lanes",
        "segment_width",
        "pipeline",
        "reload",
        "program_words",
        "operand_words",
        "table_blocks",
    )
    program: LaneProgram
    acc_width: int
    integers: tuple[IntegerNetwork, ...]
    graph: Graph
    loaded: Image | None = None
    asked: int = 1

    @classmethod
    def build(
        cls, networks: Sequence[DenseNetwork], settings: Settings, arrangement: str, variant: str
    ) -> Self:
        chosen: dict[str, Any] = {
            "lanes": 1,
            "segment_width": SEGMENT_WIDTH,
            "pipeline": "short",
            **settings.options,
        }
        lanes, width, lean = chosen["lanes"], chosen["segment_width"], settings.lean
        if not 1 <= lanes <= MOST_LANES:
            other = "" if lanes else "; adder_graph and table_graph need no multiplier"
            raise InputError(f"hardware.lanes: got {lanes}, expected 1 to {MOST_LANES}{other}")
        reload, depth = chosen.pop("reload", False), chosen.pop("pipeline")
        integers = integer_networks(arrangement, networks, settings.met, width)
        graph = _graph_of(integers, lanes, lean)
        # Straight functions alone need no table, so the width of its segments is any.
        table = joined(graph.functions, width if graph.looks_up else SEGMENT_WIDTH)
        if lean and not reload:
            table = table.within(graph.reach(table))
        acc_width = max(LEAST_ACC_WIDTH if lean else WHOLE_ACC_WIDTH, graph.sum_bits(table))
        pipeline, loaded = Pipeline(int(depth == "deep")), None
        if reload:
            loaded = own_image(graph, {**chosen, "pipeline": pipeline})
            acc_width = loaded.sizes.acc_width
            program = replace(loaded.program, shared=assign_to_lanes(graph, lanes, every=True))
        else:
            program = assemble_lanes(
                graph,
                table if graph.looks_up else None,
                lanes,
                pipeline,
                least_addr_width=LEAST_ADDR_WIDTH,
            )
        return cls(
            program,
            acc_width,
            integers,
            graph,
            loaded,
            lanes,
            useless_nodes=graph.useless_nodes,
            variant=variant,
        )

    @property
    def inputs(self) -> int:
        return self.program.inputs

    @cached_property
    def outputs(self) -> int:
        return len(self.output_clocks)

    @property
    def output_clocks(self) -> tuple[int, ...]:
        return self.program.output_clocks

    @property
    def clocks_text(self) -> str:
        """``output_clocks`` as text for the exported file, which must not depend on an image."""
        return "as the image says" if self.loaded else ", ".join(map(str, self.output_clocks))

    @property
    def latency(self) -> int:
        return self.output_clocks[0]

    @property
    def lanes(self) -> int:
        return self.program.lanes

    @property
    def rectifies(self) -> bool:
        """Whether it has ReLU."""
        return self.program.rectifies

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
        networks: Sequence[DenseNetwork],
        arrangement: str = "single",
        met: Sequence[Sequence[float]] = (),
    ) -> Image:
        """The image with which the same hardware computes other networks."""
        integers = integer_networks(arrangement, networks, met, self._sizes.segment_width)
        return image_of(_graph_of(integers, self.lanes), self._sizes)

    def received(self, data: bytes) -> Image | None:
        """The image that the loader finds in some bytes; None if it is not good."""
        found, sizes = self.image_loader.judge(data), self._sizes
        if found is None:
            return None
        before_last, words = found
        return Image(sizes, (before_last + 2) % sizes.operand_words, tuple(words))

    def running(self, image: Image) -> Self:
        """The same hardware, running another image."""
        return replace(self, program=image.program, loaded=image)

    @property
    def interval(self) -> int:
        """Samples of a frame may come once the last output of the frame before has left."""
        return self.output_clocks[-1] + self.program.pipeline.free + self.inputs - 1

    @property
    def busy(self) -> int:
        return self.interval - self.inputs

    @property
    def input_controller(self) -> FrameCheck:
        return self.frame_check

    @property
    def frame_check(self) -> FrameCheck:
        last = self.output_clocks[-1]
        return FrameCheck(self.inputs, self.addr_width, last, self.program.pipeline)

    @property
    def frame_guard(self) -> FrameGuard:
        """Replaces the frame check where the image can change."""
        return FrameGuard(self.addr_width, self.program.pipeline)

    @property
    def image_loader(self) -> ImageLoader:
        sizes = self._sizes
        return ImageLoader(sizes.words, self.addr_width, sizes.check_start)

    @property
    def _sizes(self) -> Sizes:
        if self.loaded is None:
            raise InputError(f"{self.entity}: its program is part of the hardware, expected reload")
        return self.loaded.sizes

    @property
    def addr_width(self) -> int:
        """Bits of the operand memory's address."""
        if self.loaded:
            return self.loaded.sizes.operand_addr_width
        return max(LEAST_ADDR_WIDTH, (self.program.addresses - 1).bit_length())

    @property
    def operand_memory(self) -> OperandMemory:
        return OperandMemory(self.addr_width, self.program.pipeline.memory_registers)

    @property
    def looks_up(self) -> bool:
        return bool(self.program.table)

    @property
    def alone(self) -> bool:
        """Whether one memory holds the program, and the weights and the table of a single lane."""
        return bool(self.program.beside)

    @property
    def program_memory(self) -> ProgramMemory:
        program = self.program
        registers = program.pipeline.memory_registers
        return ProgramMemory(program.words, program.notes, registers=registers)

    @property
    def program_ram(self) -> ProgramRam:
        registers = self.program.pipeline.memory_registers
        return ProgramRam(self._sizes.program_addr_width, registers)

    @property
    def lane_memories(self) -> tuple[LaneMemory, ...]:
        """The weights of each lane, and its table."""
        program = self.program
        if self.alone:
            return ()
        if self.loaded:
            room = LaneMemory(
                (0,) * self.loaded.sizes.program_words,
                (0,) * self.loaded.sizes.table_words,
                program.segment_width,
                blocks=program.blocks,
                written=True,
                variant=self.variant,
            )
            return (room,) * self.lanes
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
        control: tuple[Block, ...] = (self.frame_check,)
        if not self.alone:
            control = (self.frame_check, self.program_memory)
        if self.loaded:
            control = (self.image_loader, self.frame_guard, self.program_ram)
        return (
            *control,
            *[self.operand_memory] * self.lanes,
            *self.lane_memories,
            *self.accumulators,
            *self.rounds,
        )

    def facts(self) -> tuple[str, ...]:
        count = "one" if self.lanes == 1 else str(self.lanes)
        spent = f"{self.output_clocks[-1]} clocks from the last sample to the last output"
        return (f"{count} multiplier{'s' * (self.lanes > 1)}", spent, *self.function_facts)

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

    def left_out(self) -> list[str]:
        # Each word that is left out saves memory, and each step saves a clock of every frame.
        texts = self.left_out_of()
        if self.graph.useless_terms:
            texts.append(f"{self.graph.useless_terms} products of weight 0")
        if self.asked > self.lanes:
            texts.append(f"{self.asked - self.lanes} lanes that no layer has a node for")
        bits = WHOLE_ACC_WIDTH - self.acc_width
        if bits > 0:
            which = "each sum" if self.lanes > 1 else "the sum"
            texts.append(
                f"{bits} bits of {which}, which {WHOLE_ACC_WIDTH} would hold for any scene"
            )
        return texts

    def flow(self) -> Flow:
        memory: list[Step] = []
        for one in self.lane_memories[:1]:
            memory = [one, Wire("a coefficient in each lane", WORD)]
        words = f"a word in each of {self.lanes} lanes" if self.lanes > 1 else "a word"
        return Flow(
            (
                Wire(f"{self.inputs} x", SIGNAL),
                self.rounds[0],
                Wire("samples, results", WORD),
                self.operand_memory,
                Wire(words, WORD),
                *memory,
                self.accumulators[0],
                Wire(f"{self.outputs} y", SIGNAL),
            ),
            watcher=self.frame_guard if self.loaded else self.frame_check,
        )

    def compute(self, frames: Codes) -> Codes:
        results = [words[0] for step, _, words in self.program.run(frames) if step.output]
        return np.stack(results, axis=-1) >> OUTPUT_SHIFT

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
            for place, relu, sums, word in self.program.stored(frames[part]):
                if place in layers:
                    found = sums >> DROPPED
                    counts[layers[place]][part] += (found > word) | ((found < word) & (not relu))
        return counts


def _graph_of(integers: Sequence[IntegerNetwork], lanes: int, lean: bool = True) -> Graph:
    """The graph of networks that so many lanes can compute."""
    if lanes > 1 and any(layer.added for network in integers for layer in network.layers):
        raise InputError(
            f"hardware.lanes: got {lanes} for sums of functions, expected 1, which looks "
            "up one function after the other"
        )
    return graph_of(integers, lean)
