"""LearningEngine: an engine that learns the gains and offsets of its sensors."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

from golden.common.block import Block
from golden.common.port import Port, input_port, output_port
from golden.engine.datapath import MultiplyAccumulate, OperandSelect, RoundSaturate, TableAddress
from golden.engine.frame_check import FrameCheck, FrameGuard
from golden.engine.memories import OperandMemory
from golden.input_error import InputError
from golden.learning.corrected import Corrected
from golden.learning.program import EQUATIONS, PIPELINE, LessonProgram, lesson_program
from golden.networks.engine import LEAST_ACC_WIDTH, LEAST_ADDR_WIDTH, Engine
from golden.networks.network import Network
from golden.numbers.fixed import Codes
from golden.numbers.precision import SIGNAL


@dataclass(frozen=True)
class LearningEngine(Network):
    """An engine whose program also learns, from known outputs of frames (ours).

    engine: The engine of the same networks that does not learn.

    It learns in the clocks that frames leave free. Frames come in the same clocks whether it learns
    or not.
    """

    block = "learning_engine"
    program: LessonProgram
    engine: Engine

    @classmethod
    def of(cls, engine: Engine, taught: Corrected, constants: Sequence[Sequence[int]]) -> Self:
        """The engine that learns in the place of one that does not.

        taught: Its networks behind sensors that are corrected.
        constants: The step and the leak of each output; see ``golden.learning.gradient``.
        """
        other = engine.lanes != 1 or engine.loaded
        if other or engine.program.pipeline.memory_registers:
            raise InputError(
                "hardware.learning: got 'lms' with lanes other than 1, pipeline 'deep' or "
                "reload, expected none of them"
            )
        if engine.integers != taught.networks:
            raise InputError(
                "hardware.learning: got networks of another arrangement or segment_width, expected "
                "a cascade, or a single network, with the default"
            )
        program = lesson_program(taught, constants, engine.graph, LEAST_ADDR_WIDTH)
        return cls(program, engine, variant=engine.variant)

    @property
    def inputs(self) -> int:
        return self.program.places.sensors

    @property
    def outputs(self) -> int:
        return self.program.places.outputs

    @property
    def output_clocks(self) -> tuple[int, ...]:
        return self.program.output_clocks

    @property
    def clocks_text(self) -> str:
        return ", ".join(map(str, self.output_clocks))

    @property
    def latency(self) -> int:
        return self.output_clocks[0]

    @property
    def interval(self) -> int:
        return self.busy + self.inputs

    @property
    def busy(self) -> int:
        return self.output_clocks[-1] + PIPELINE.free - 1

    @property
    def equation_clocks(self) -> tuple[int, ...]:
        """Clocks in one piece that the equation of each output takes."""
        around = PIPELINE.run + PIPELINE.result
        return tuple(around + steps for steps in self.program.lengths[EQUATIONS:])

    @property
    def longest_equation(self) -> int:
        """The most clocks in one piece that an equation takes."""
        return max(self.equation_clocks)

    @property
    def placements(self) -> int:
        return self.program.placements

    @property
    def ports(self) -> tuple[Port, ...]:
        return super().ports + self.lesson_ports

    @property
    def lesson_ports(self) -> tuple[Port, ...]:
        return (
            input_port("target_valid", "`target_data` holds a word"),
            input_port(
                "target_data",
                "known output y of the last frame, in the order of the outputs, or an element of "
                "theta, which stands for 1024 times itself",
                SIGNAL,
            ),
            input_port("target_last", "this is the last word"),
            input_port("target_theta", "the words are theta, the same for all of a stream"),
            output_port("target_ready", "a word is taken in this clock"),
            output_port(
                "target_error",
                "high for one clock for each such stream of the wrong length, without a frame "
                "before, behind a frame with a sample at an end of its range, or that a frame "
                "interrupts; nothing of it is kept",
            ),
            input_port("learn", "it learns from the placements that it keeps"),
            output_port(
                "learn_error",
                "high for one clock for each step that would leave the range, which is not taken",
            ),
            output_port(
                "theta_valid",
                "`theta_data` holds an element of the theta in use; all come behind each frame, in "
                "their order, as far as no sample comes before",
            ),
            output_port("theta_data", "1024 times the element, truncated", SIGNAL),
        )

    @property
    def input_controller(self) -> FrameCheck:
        return self.frame_check

    @property
    def frame_check(self) -> FrameCheck:
        width = self.program.places.sample_width
        return FrameCheck(self.inputs, width, self.output_clocks[-1], PIPELINE, results=False)

    @property
    def frame_guard(self) -> FrameGuard:
        """Takes known outputs as if they were samples; only the lowest bits of addresses count."""
        return FrameGuard(LEAST_ADDR_WIDTH, PIPELINE)

    @property
    def operand_memory(self) -> OperandMemory:
        """There are two of them, with the same words."""
        return OperandMemory(self.program.places.addr_width)

    @property
    def table_address(self) -> TableAddress:
        return TableAddress(self.program.table.width, self.program.table.segments)

    @property
    def operand_select(self) -> OperandSelect:
        return OperandSelect(self.program.table.width)

    @property
    def multiply_accumulate(self) -> MultiplyAccumulate:
        return MultiplyAccumulate(self.acc_width)

    @property
    def round_saturate(self) -> RoundSaturate:
        return RoundSaturate(self.acc_width)

    @property
    def acc_width(self) -> int:
        return max(LEAST_ACC_WIDTH, self.program.acc_width)

    @property
    def program_addr_width(self) -> int:
        return (len(self.program.words) - 1).bit_length()

    @property
    def contents(self) -> tuple[int, ...]:
        """All words of the program memory, filled with zeros up to a power of two."""
        words = self.program.words
        return words + (0,) * ((1 << self.program_addr_width) - len(words))

    def parts(self) -> tuple[Block, ...]:
        return (
            self.frame_check,
            self.frame_guard,
            self.operand_memory,
            self.table_address,
            self.operand_select,
            self.multiply_accumulate,
            self.round_saturate,
        )

    def facts(self) -> tuple[str, ...]:
        spent = f"{self.output_clocks[-1]} clocks from the last sample to the last output"
        equations = f"{sum(self.equation_clocks)} clocks for a pass over one placement"
        return "one multiplier", spent, f"{self.placements} placements are kept", equations

    def compute(self, frames: Codes) -> Codes:
        """The outputs after a reset, before anything is learned."""
        return self.engine.compute(frames)
