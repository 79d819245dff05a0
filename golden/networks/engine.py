"""Engine: a whole scene on one multiplier, or on none, and a program."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

from golden.block import Block
from golden.dense import Trained
from golden.engine.exact import error_bounds, exact
from golden.engine.frame_check import FrameCheck
from golden.engine.frame_guard import FrameGuard
from golden.engine.graph import Graph
from golden.engine.image import ACC_WIDTH, Image, Sizes, image_of
from golden.engine.image_loader import ImageLoader
from golden.engine.layers import graph_of
from golden.engine.multiply_accumulate import MultiplyAccumulate
from golden.engine.operand_memory import WORD, OperandMemory
from golden.engine.operand_select import OperandSelect
from golden.engine.pipeline import Pipeline, SerialPipeline
from golden.engine.plane_select import PlaneSelect
from golden.engine.program import Program, assemble
from golden.engine.program_memory import ProgramMemory
from golden.engine.program_ram import ProgramRam
from golden.engine.replay_memory import ReplayMemory
from golden.engine.round_saturate import RoundSaturate
from golden.engine.serial_accumulate import SerialAccumulate
from golden.engine.serial_program import SerialProgram, assemble_serial
from golden.engine.table_address import TableAddress
from golden.engine.tanh_table import tanh_table
from golden.fixed import Codes
from golden.flow import Carried, Flow
from golden.input_error import InputError
from golden.mlp import Mlp
from golden.networks.design import Design
from golden.port import Port, Unsigned, given, taken
from golden.precision import EXACT, SIGNAL, Precision
from golden.real import Real

# What multiplies, the smallest first.
KINDS = ("serial", "dsp")
# Smaller memories would be made of LUTs in some devices, which are slower behind a block RAM.
LEAST_ADDR_WIDTH = 7
# With fewer, Yosys makes the test for saturation anew for each bit that it chooses.
LEAST_ACC_WIDTH = 38
# Bits of a sum that no scene of weights below 512 leaves.
WHOLE_ACC_WIDTH = 44
LOAD_PORTS = (
    taken("load_valid", "`load_data` holds a byte of an image"),
    taken("load_data", "the byte", Unsigned(8)),
    taken("load_last", "the byte is the last of the image"),
    given("load_ready", "a byte is taken in this clock; not while a frame is computed"),
    given("image_error", "the last image was not valid"),
)


@dataclass(frozen=True)
class Engine(Design):
    """Every neuron of a scene, one product a clock (ours; single, multiple and cascade alike).

    Without a multiplier, with ``multiplier = "serial"``, a product takes as many clocks as its
    operand has bits. Results are the same.

    Parameters
    ----------
    program : Program
    acc_width : int
        Bits of the sum: no sum of the program leaves them.
    graph : Graph
        What the program was made from.
    loaded : Image or None
        What an engine that can be reloaded runs; its hardware depends on ``loaded.sizes`` alone.
        None for a program that is part of the hardware.
    budget : int
        Clocks from the last sample to the last output that the scene asks for; 0 for none.
    """

    block = "engine"
    arrangements = ("single", "multiple", "cascade")
    precisions = (EXACT.name,)
    known_activations = ("precise",)
    options = (
        "segment_width",
        "pipeline",
        "multiplier",
        "clocks",
        "reload",
        "program_words",
        "operand_words",
    )
    program: Program
    acc_width: int
    graph: Graph
    loaded: Image | None = None
    budget: int = 0

    @classmethod
    def of_several(
        cls,
        arrangement: str,
        networks: Sequence[Trained],
        lean: bool = True,
        hardware: Mapping[str, object] | None = None,
        activation_options: Mapping[str, object] | None = None,
        variant: str = "",
    ) -> Self:
        """The engine of all networks of a scene.

        Parameters
        ----------
        arrangement : str
        networks : sequence of Mlp or DenseNetwork
        lean : bool
            Leave out terms of zero weight, hidden nodes that no output uses, and segments of the
            table that no hidden sum reaches. Results are the same either way.
        hardware : mapping, optional
            What the scene chooses of ``options``.
        activation_options : mapping, optional
            None: its activation has no other form.
        variant : str
        """
        chosen: dict[str, Any] = {"segment_width": 9, "pipeline": "short"} | dict(hardware or {})
        budget = chosen.pop("clocks", 0)
        if budget:
            return cls._within(budget, arrangement, networks, lean, chosen, variant)
        serial = chosen.pop("multiplier", "dsp") == "serial"
        depth, reload = chosen.pop("pipeline"), chosen.pop("reload", False)
        if serial and depth != "short":
            raise InputError(
                f"hardware.pipeline: got {depth!r} with multiplier 'serial', expected 'short'"
            )
        if serial and reload:
            raise InputError(
                "hardware.reload: got True with multiplier 'serial', expected multiplier 'dsp'"
            )
        table = tanh_table(chosen["segment_width"])
        graph = graph_of(arrangement, networks, lean)
        if graph.rectifies and reload:
            raise InputError(
                "hardware.reload: got True for a network with ReLU, expected False: what an image "
                "is loaded into has no ReLU"
            )
        segments = len(table.slopes)
        if lean and not reload:
            segments = min(segments, (graph.reach(table) >> table.width) + 1)
        program: Program
        if serial:
            program = assemble_serial(graph, table, segments, SerialPipeline())
        else:
            pipeline = Pipeline(int(depth == "deep"))
            program = assemble(graph, table, segments, pipeline)
        bound = max(graph.bound(neuron, table) for neuron in graph.neurons).bit_length() + 1
        least = LEAST_ACC_WIDTH if lean else WHOLE_ACC_WIDTH
        loaded = None
        if reload:
            loaded = image_of(program, bound, Sizes(**chosen, pipeline=pipeline))
            program = loaded.program
        return cls(
            program,
            ACC_WIDTH if loaded else max(least, bound),
            graph,
            loaded,
            useless_nodes=graph.useless_nodes,
            variant=variant,
        )

    @classmethod
    def _within(
        cls,
        clocks: int,
        arrangement: str,
        networks: Sequence[Trained],
        lean: bool,
        chosen: dict[str, Any],
        variant: str,
    ) -> Self:
        """The smallest engine whose last output leaves ``clocks`` after the last sample.

        Raises
        ------
        InputError
            When none does; the message says what the fastest takes.
        """
        # Without a multiplier there is one pipeline, and no image.
        kinds = ["dsp"] if chosen["pipeline"] != "short" or chosen.get("reload") else list(KINDS)
        kinds = [chosen["multiplier"]] if "multiplier" in chosen else kinds
        for kind in kinds:
            engine = cls.of_several(
                arrangement, networks, lean, chosen | {"multiplier": kind}, variant=variant
            )
            if engine.output_clocks[-1] <= clocks:
                return replace(engine, budget=clocks)
        raise InputError(
            f"hardware.clocks: got {clocks}, expected {engine.output_clocks[-1]} or more, which "
            f"multiplier {kind!r} takes"
        )

    @classmethod
    def of(
        cls,
        network: Trained,
        precision: Precision,
        activation: str,
        options: Mapping[str, object] | None = None,
        variant: str = "",
        lean: bool = True,
        hardware: Mapping[str, object] | None = None,
    ) -> Self:
        return cls.of_several("single", [network], lean, hardware, variant=variant)

    @property
    def inputs(self) -> int:
        return self.program.inputs

    @property
    def hidden_weights(self) -> list[Sequence[int]]:
        return [
            [sum(t.weight for t in neuron.terms if t.source == k) for k in range(self.inputs)]
            for neuron in self.graph.first_sums
        ]

    @cached_property
    def outputs(self) -> int:
        return len(self.output_clocks)

    @cached_property
    def output_clocks(self) -> tuple[int, ...]:
        """The steps of the outputs, from the last sample on."""
        return tuple(map(self.program.clock, self.program.output_steps))

    @property
    def clocks_text(self) -> str:
        """``output_clocks`` for the exported file, which must not depend on an image."""
        return "as the image says" if self.loaded else ", ".join(map(str, self.output_clocks))

    @property
    def latency(self) -> int:
        return self.output_clocks[0]

    @property
    def interval(self) -> int:
        """Samples of a frame come when the last output of the one before has left."""
        return self.output_clocks[-1] + self.program.pipeline.free + self.inputs - 1

    @property
    def busy(self) -> int:
        return self.output_clocks[-1] + self.program.pipeline.free - 1

    @property
    def serial(self) -> bool:
        """Whether it does without a multiplier."""
        return isinstance(self.program, SerialProgram)

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

    def running(self, image: Image) -> Self:
        """The same hardware with another image."""
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
        """In the place of the frame check, where the image can change."""
        return FrameGuard(self.addr_width, self.program.pipeline)

    @property
    def image_loader(self) -> ImageLoader:
        sizes = self._sizes
        return ImageLoader(sizes.program_addr_width, self.addr_width, sizes.check_start)

    @property
    def program_ram(self) -> ProgramRam:
        """In the place of the program memory, where the image can change."""
        return ProgramRam(
            self._sizes.program_addr_width,
            self._sizes.segments,
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
        return TableAddress(width, kept, beyond=kept == len(tanh_table(width).slopes))

    @property
    def operand_select(self) -> OperandSelect:
        # As late as the word of the table.
        return OperandSelect(self.program.segment_width, self.program.pipeline.table)

    @property
    def multiply_accumulate(self) -> MultiplyAccumulate:
        return MultiplyAccumulate(self.acc_width)

    @property
    def round_saturate(self) -> RoundSaturate:
        return RoundSaturate(self.acc_width, self.rectifies, self.program.cut, self.program.even)

    @property
    def replay_memory(self) -> ReplayMemory:
        """Takes the place of ``program_memory`` where there is no multiplier."""
        return ReplayMemory(
            self.program.table,
            self.program.words,
            self.program.notes,
            self.table_address.addr_width + 1,
        )

    @property
    def plane_select(self) -> PlaneSelect:
        """Takes the place of ``operand_select``."""
        return PlaneSelect(self.program.segment_width)

    @property
    def serial_accumulate(self) -> SerialAccumulate:
        """Takes the place of ``multiply_accumulate``."""
        return SerialAccumulate(self.acc_width)

    @property
    def steps(self) -> tuple[Block, ...]:
        """What reads the program, chooses operands and adds up."""
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

    def flow(self) -> Flow:
        _, select, accumulate = self.steps
        return Flow(
            (
                Carried(f"{self.inputs} x", SIGNAL),
                self.round_saturate,
                Carried("samples, results", WORD),
                self.operand_memory,
                Carried("a word", WORD),
                select,
                Carried("an operand", WORD),
                accumulate,
                Carried(f"{self.outputs} y", SIGNAL),
            ),
            watcher=self.frame_guard if self.loaded else self.frame_check,
        )

    def facts(self) -> tuple[str, ...]:
        multiplier = "no multiplier" if self.serial else "one multiplier"
        budget = f" of {self.budget}" if self.budget else ""
        spent = f"{self.output_clocks[-1]}{budget} clocks from the last sample to the last output"
        return multiplier, spent

    def left_out(self) -> list[str]:
        """What is counted as words costs memory and, one each, a clock of every frame."""
        graph, program = self.graph, self.program
        texts = []
        if self.serial:
            spent = f"{self.output_clocks[-1]} clocks"
            budget = f" of {self.budget}" if self.budget else ""
            texts.append(f"the multiplier: {spent}{budget} are enough for bit after bit")
        if graph.useless_nodes:
            texts.append(f"{graph.useless_nodes} hidden nodes whose weights to the outputs are 0")
        if graph.useless_terms:
            texts.append(f"{graph.useless_terms} steps of weight 0")
        words = len(tanh_table(program.segment_width).slopes) - program.segments
        if words:
            texts.append(f"{words} words of tanh that no hidden sum reaches, and their comparison")
        bits = WHOLE_ACC_WIDTH - self.acc_width
        if bits:
            texts.append(
                f"{bits} bits of the sum, which {WHOLE_ACC_WIDTH} would hold for any scene"
            )
        return texts

    def exact(self, frames: Codes) -> Codes:
        return exact(self.graph, self.program.segment_width, frames)

    def error_bounds(self, mlp: Mlp, precision: Precision, sensors: int) -> Real:
        return error_bounds(mlp, self.program.segment_width, sensors)

    def compute(self, frames: Codes) -> Codes:
        return self.program.execute(frames)
